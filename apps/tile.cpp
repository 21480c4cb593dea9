// pss tile: builds a store once, to be used many times.

#include "stream/jobs/tile.h"

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/ingest_text.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/report_file.h"
#include "core/parallel.h"
#include "io/inputs.h"

namespace pss {

namespace {

void tell(const JobReport& report, Progress& progress) {
  if (report.already_complete) return progress.note(report.output + ": already complete");
  for (const std::string& note : report.notes) progress.note(note);
  for (const std::string& line : ingest_lines(report.ingest)) progress.note(line);
  progress.note(fmt::format("{}: {} points in {}; peak memory {} of {}", report.output,
                            grouped(report.points_out), short_time(progress.seconds()),
                            short_size(report.peak_memory), short_size(report.memory_limit)));
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
                     job_.lattice_step, parse_scale);
    declare_drop_outside(arguments, job_.drop_outside);
    limits_.declare(arguments);
    declare_work(arguments, job_);
    declare_tile_points(arguments, job_);
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
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    PSS_ASSIGN(job_.inputs, expand_inputs(inputs_, job_.output));
    job_.state_folder = state_folder();
    Progress progress(reports_.progress);  // from here on a signal ends it in order
    PSS_ASSIGN(const ReportFile file, ReportFile::claim(reports_.report, "tile", job_, inputs_));
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    PSS_ASSIGN(const JobReport report, tile(job_, budget, progress));
    tell(report, progress);
    return file.write(tile_json(report));
  }

  bool resumable() const override { return true; }

 private:
  std::vector<std::string> inputs_;
  TileJob job_;
  LimitOptions limits_;
  ReportOptions reports_;
};

}  // namespace

std::unique_ptr<Command> make_tile() { return std::make_unique<Tile>(); }

}  // namespace pss
