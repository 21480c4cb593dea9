// pss tile: builds a store once, to be used many times.

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "apps/command.h"
#include "apps/ingest_text.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/report_file.h"
#include "core/parallel.h"
#include "io/file/fingerprint.h"
#include "io/inputs.h"
#include "stream/jobs/job.h"
#include "stream/sort/ingest.h"
#include "stream/sort/ingest_memory.h"
#include "stream/store/input_memory.h"

namespace pss {

namespace {

/// A job whose work directory holds the store until it is whole.
struct TileJob {
  std::vector<std::string> inputs;
  std::string output;
  IngestOptions ingest;
  JobOptions directory;

  JobPlaces places() const {
    return {inputs,
            output,
            directory.work_dir,
            state_folder(),
            directory.overwrite,
            directory.restart,
            directory.keep_work};
  }
};

Result<JobRecord> record_of(const TileJob& job) {
  const nlohmann::json sorting = {
      {"tile-points", job.ingest.tile_points},
      {"scale", job.ingest.scale ? nlohmann::json(*job.ingest.scale) : nlohmann::json()},
      {"drop-outside", job.ingest.drop_outside ? nlohmann::json{job.ingest.drop_outside->min,
                                                                job.ingest.drop_outside->max}
                                               : nlohmann::json()}};
  JobRecord record{
      .command = "tile", .output = job.output, .sorting = sorting.dump(), .parameters = "{}"};
  for (const std::string& input : job.inputs) {
    PSS_ASSIGN(InputRecord found, settled_fingerprint(input));
    record.inputs.push_back(std::move(found));
  }
  return record;
}

class Tile : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positionals("INPUT", "Files, directories, globs, @list.txt", inputs_);
    arguments.option("-o,--output", "NAME.pss", "The store (required)", job_.output, parse_output);
    arguments.required();
    arguments.option("--scale", "S|X,Y,Z",
                     "Step of the common lattice, for inputs that fit none "
                     "[LAS: the finest scale of the inputs]",
                     job_.ingest.scale, parse_scale);
    declare_drop_outside(arguments, job_.ingest.drop_outside);
    limits_.declare(arguments);
    job_.directory.declare(arguments);
    arguments.option("--tile-points", "N", "Points a tile owns at most, for experiments [262144]",
                     job_.ingest.tile_points, parse_tile_points);
    reports_.declare_progress(arguments);
    reports_.declare_report(arguments);
    arguments.epilogue(
        "A store holds the points in spatial order, cut into compressed tiles; smooth takes one\n"
        "instead of files. Interrupted or killed, the same command goes on where it stopped.\n"
        "The page docs/report.md lies in share/doc/pss where pss is installed.\n\n"
        "Examples:\n"
        "  pss tile scans/*.las -o scans.pss --memory-limit 2G\n"
        "  pss tile @list.txt -o all.pss --work-dir tmp/work");
  }

  Result<void> run() override {
    if (!is_store_name(job_.output))
      return Error{Fault::kUsage,
                   fmt::format("--output: found '{}', expected NAME.pss", job_.output)};
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    PSS_ASSIGN(job_.inputs, expand_inputs(inputs_, job_.output));
    PSS_TRY(check_files(job_.inputs));
    PSS_TRY(check_output(job_.inputs, job_.output));
    const JobPlaces places = job_.places();
    Progress progress(reports_.progress);  // from here on a signal ends it in order
    PSS_ASSIGN(
        const ReportFile report,
        ReportFile::claim(reports_.report, {"tile", job_.inputs, job_.output,
                                            places.work_directory(), places.overwrite, inputs_}));
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    PSS_TRY(check_places(places));
    PSS_ASSIGN(JobRecord record, record_of(job_));
    PSS_ASSIGN(const Reservation held, reserve_inputs(job_.inputs, least_memory(), budget));
    PSS_ASSIGN(Job started, Job::enter(places, std::move(record), progress));
    if (started.complete()) {
      progress.note(job_.output + ": already complete");
      return report.write(already_complete());
    }
    const auto built = build(started, budget, progress);
    return built ? report.write(report_of(*built)) : started.fail(built.error());
  }

  bool resumable() const override { return true; }

 private:
  LeastMemory least_memory() const {
    return [this](StoreHeader header, std::uint64_t points, std::size_t unit) {
      header.tile_points = job_.ingest.tile_points;
      return least_ingest_memory(header, points, unit);
    };
  }

  Result<IngestSummary> build(Job& started, MemoryBudget& budget, Progress& progress) {
    const WorkDirectory& work = started.work();
    PSS_ASSIGN(const IngestPlan plan, plan_ingest(started.record().inputs, job_.ingest, progress));
    for (const std::string& note : plan.notes) progress.note(note);
    PSS_ASSIGN(const IngestSummary summary,
               ingest(plan, work.input_store(), work.path(), job_.ingest, budget, progress));
    PSS_TRY(started.hand_over_store(work.input_store()));
    PSS_TRY(started.leave());
    tell(summary, budget, progress);
    return summary;
  }

  nlohmann::ordered_json described() const {
    return {{"command", "tile"}, {"inputs", job_.inputs}, {"output", job_.output}};
  }
  std::string dump(const nlohmann::ordered_json& json) const {
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  std::string already_complete() const {
    nlohmann::ordered_json json = described();
    json["already_complete"] = true;
    return dump(json);
  }
  std::string report_of(const IngestSummary& summary) const {
    nlohmann::ordered_json json = described();
    json.update(nlohmann::ordered_json::parse(to_json(summary)));
    return dump(json);
  }

  void tell(const IngestSummary& summary, const MemoryBudget& budget, Progress& progress) const {
    for (const std::string& line : ingest_lines(summary)) progress.note(line);
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
