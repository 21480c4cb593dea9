// pss tile: builds a store once, to be used many times.

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "core/parallel.h"
#include "io/inputs.h"
#include "stream/fingerprint.h"
#include "stream/ingest.h"
#include "stream/job.h"
#include "stream/smooth_job.h"

namespace pss {

namespace {

/// A job whose work directory holds the store until it is whole.
struct TileJob {
  std::vector<std::string> inputs;
  std::string output;
  IngestOptions ingest;
  JobOptions directory;

  std::string work_dir() const {
    return directory.work_dir.empty() ? output + ".work" : directory.work_dir;
  }
};

Result<JobRecord> record_of(const TileJob& job) {
  const nlohmann::json parameters = {
      {"tile-points", job.ingest.tile_points},
      {"scale", job.ingest.scale ? nlohmann::json(*job.ingest.scale) : nlohmann::json()}};
  JobRecord record{.command = "tile", .output = job.output, .parameters = parameters.dump()};
  for (const std::string& input : job.inputs) {
    PSS_ASSIGN(InputRecord found, fingerprint(input));
    record.inputs.push_back(std::move(found));
  }
  return record;
}

/// Whether the job is complete already; otherwise its work directory is ready to work in.
Result<bool> enter(const TileJob& job, const WorkDirectory& work, JobRecord& record) {
  if (job.directory.restart) PSS_TRY(work.clear());
  PSS_ASSIGN(std::optional<JobRecord> before, work.read_record());
  if (before && check_same_job(*before, record, work.path()) &&
      wrote(*before, manifest_path(job.output)))
    return true;
  if (exists(job.output) && !job.directory.overwrite)
    return Error{Fault::kFailed,
                 fmt::format("{}: exists; use --overwrite to replace it", job.output)};
  if (before && before->complete) {  // its output is gone, or is to be replaced
    PSS_TRY(work.clear());
    before.reset();
  }
  if (before) PSS_TRY(check_same_job(*before, record, work.path()));
  PSS_TRY(work.write_record(record));
  return false;
}

/// Gives the finished store its name, and leaves the record that tells the same command so.
Result<void> leave(const TileJob& job, const WorkDirectory& work, JobRecord& record) {
  // Recorded first: a job stopped after the rename knows its output again.
  PSS_ASSIGN(record.result, fingerprint(manifest_path(work.input_store())));
  PSS_TRY(work.write_record(record));
  if (job.directory.overwrite) PSS_TRY(remove_store(job.output));
  PSS_TRY(rename_file(work.input_store(), job.output));
  record.complete = true;
  PSS_ASSIGN(record.result, fingerprint(manifest_path(job.output)));
  PSS_TRY(work.write_record(record));
  return job.directory.keep_work ? Result<void>() : work.remove_data();
}

class Tile : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positionals("INPUT", "Files, directories, globs, @list.txt", inputs_);
    arguments.option("-o,--output", "NAME.pss", "The store (required)", job_.output, parse_text);
    arguments.required();
    arguments.option("--scale", "S|X,Y,Z",
                     "Step of the common lattice, for inputs that fit none "
                     "[LAS: the finest scale of the inputs]",
                     job_.ingest.scale, parse_scale);
    limits_.declare(arguments);
    job_.directory.declare(arguments);
    arguments.option("--tile-points", "N", "Points a tile owns at most, for experiments [262144]",
                     job_.ingest.tile_points, parse_tile_points);
    reports_.declare_progress(arguments);
    reports_.declare_report(arguments);
    arguments.epilogue(
        "A store holds the points in spatial order, cut into compressed tiles; smooth takes one\n"
        "instead of files. Interrupted or killed, the same command goes on where it stopped.\n\n"
        "Examples:\n"
        "  pss tile scans/*.las -o scans.pss --memory-limit 2G\n"
        "  pss tile @list.txt -o all.pss --work-dir /fast/disk/work");
  }

  Result<void> run() override {
    if (!is_store_name(job_.output))
      return Error{Fault::kUsage,
                   fmt::format("--output: found '{}', expected NAME.pss", job_.output)};
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    PSS_ASSIGN(job_.inputs, expand_inputs(inputs_));
    PSS_TRY(check_output(job_.inputs, job_.output));
    PSS_TRY(reports_.check());
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    Progress progress(reports_.progress);
    PSS_ASSIGN(const WorkDirectory work, WorkDirectory::open(job_.work_dir()));
    PSS_ASSIGN(JobRecord record, record_of(job_));
    PSS_ASSIGN(const bool complete, enter(job_, work, record));
    if (complete) {
      progress.note(job_.output + ": already complete");
      return {};
    }
    return build(work, record, budget, progress);
  }

  bool resumable() const override { return true; }

 private:
  Result<void> build(const WorkDirectory& work, JobRecord& record, MemoryBudget& budget,
                     Progress& progress) {
    PSS_ASSIGN(const IngestPlan plan, plan_ingest(job_.inputs, job_.ingest, progress));
    for (const std::string& note : plan.notes) progress.note(note);
    PSS_ASSIGN(const IngestSummary summary,
               ingest(plan, work.input_store(), work.path(), job_.ingest, budget, progress));
    PSS_TRY(leave(job_, work, record));
    tell(summary, budget, progress);
    return reports_.write(to_json(summary));
  }

  void tell(const IngestSummary& summary, const MemoryBudget& budget, Progress& progress) const {
    if (summary.dropped_not_finite > 0)
      progress.note(fmt::format("dropped {} points whose position is not finite",
                                grouped(summary.dropped_not_finite)));
    if (summary.moved_to_lattice > 0)
      progress.note(fmt::format("moved {} points onto the common lattice, by {:.3g} at most",
                                grouped(summary.moved_to_lattice), summary.largest_move));
    progress.note(fmt::format("{}: {} points in {}; peak memory {} of {}", job_.output,
                              grouped(summary.points_stored), short_time(progress.seconds()),
                              short_size(peak_resident()), short_size(budget.limit())));
  }

  std::vector<std::string> inputs_;
  TileJob job_;
  LimitOptions limits_;
  ReportOptions reports_;
};

}  // namespace

std::unique_ptr<Command> make_tile() { return std::make_unique<Tile>(); }

}  // namespace pss
