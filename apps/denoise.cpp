// pss denoise: drops or classifies outliers, out of core.

#include "stream/jobs/denoise.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/estimate_text.h"
#include "apps/ingest_text.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/report_file.h"
#include "core/parallel.h"
#include "io/inputs.h"

namespace pss {
namespace {

constexpr const char* kEpilogue =
    "Lengths are in the scan's units. Methods:\n"
    "statistical: the mean distance of each point to its K nearest; an outlier is a point where "
    "it\n"
    "exceeds the mean over the scan by N standard deviations, or that has fewer than K points\n"
    "within the radius. radius: fewer than K points lie within the radius. residual: no surface "
    "is\n"
    "found within the width, or the points around lie farther off it than F times the width, as "
    "in\n"
    "vegetation and scatter. A scan's density should not vary much for the first two.\n"
    "Duplicates count as neighbours of each other. Points of classes 7 and 18 and withheld points\n"
    "are no neighbours, are not judged, and stay as they are.\n"
    "Without --classify outliers are dropped, and counted; with it all points stay, and outliers\n"
    "get class 7, with --high class 18 where they lie above the points around them; a point with\n"
    "nothing at all within the radius counts as low.\n"
    "--outputs measured adds the value that decided: MeanDistance, NeighborCount, or FitResidual\n"
    "(over the width); -1 where there is none.\n"
    "Interrupted or killed, the same command goes on where it stopped, and ends with the same\n"
    "bytes; they depend on neither threads, memory limit nor tile size.\n"
    "The page docs/denoise.md lies in share/doc/pss where pss is installed.\n\n"
    "Examples:\n"
    "  pss denoise scan.las -o clean.las\n"
    "  pss denoise tiles/ -o marked.las --classify --high --knn 12 --multiplier 3\n"
    "  pss denoise scan.ply -o clean.ply --method radius --radius 0.1 --knn 5\n"
    "  pss denoise city.pss -o surfaces.las --method residual --h 0.4 --report report.json";

Result<bool> parse_outputs_word(std::string_view text) {
  if (text == "measured") return true;
  return Error{Fault::kUsage, fmt::format("found '{}', expected measured", text)};
}

void tell(const DenoiseReport& report, Progress& progress) {
  if (report.already_complete) return progress.note(report.output + ": already complete");
  for (const std::string& note : report.notes) progress.note(note);
  for (const std::string& line : ingest_lines(report.ingest)) progress.note(line);
  const DenoiseChoices& choices = report.choices;
  const std::string by =
      report.options.rule == OutlierRule::kStatistical
          ? fmt::format("mean distance {:.4g}, deviation {:.4g}, threshold {:.4g}", choices.mean,
                        choices.deviation, choices.threshold)
          : fmt::format("threshold {:.4g}", choices.threshold);
  progress.note(fmt::format("{}: {}", name_of(report.options.rule), by));
  progress.note(fmt::format(
      "outliers {} {} ({} above their neighbours, {} without enough around them); excluded {}",
      report.options.classify ? "classified" : "dropped", grouped(report.counts.outliers()),
      grouped(report.counts.high), grouped(choices.nothing), grouped(report.counts.excluded)));
  progress.note(fmt::format("{}: {} points in {}; peak memory {} of {}", report.output,
                            grouped(report.points_out), short_time(report.total_seconds),
                            short_size(report.peak_memory), short_size(report.memory_limit)));
}

class Denoise : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positionals("INPUT", "Files, directories, globs, @list.txt, or one store NAME.pss",
                          inputs_);
    arguments.option("-o,--output", "OUTPUT",
                     "A file (the extension says the format), or NAME.pss to keep the store "
                     "(required)",
                     job_.output, parse_output);
    arguments.required();
    declare_rule(arguments);
    declare_drop_outside(arguments, job_.drop_outside);
    grid_.declare(arguments);
    limits_.declare(arguments);
    declare_work(arguments, job_);
    arguments.flag("--dry-run", "Only tell tiles, halo, memory, disk and time that it would take",
                   dry_run_);
    reports_.declare_progress(arguments);
    reports_.declare_report(arguments);
    declare_tile_points(arguments, job_);
    arguments.epilogue(kEpilogue);
  }

  Result<void> run() override {
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    PSS_ASSIGN(job_.inputs, expand_inputs(inputs_, job_.output));
    job_.options.rule = named(kOutlierRules, rule_).value_or(job_.options.rule);
    grid_.put_into(job_);
    job_.state_folder = state_folder();
    Progress progress(reports_.progress);  // from here on a signal ends it in order
    PSS_ASSIGN(const ReportFile file, ReportFile::claim(reports_.report, "denoise", job_, inputs_));
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    if (dry_run_) return estimate(file, budget, progress);
    PSS_ASSIGN(const DenoiseReport report, denoise(job_, budget, progress));
    tell(report, progress);
    return file.write(to_json(report));
  }

  bool resumable() const override { return !dry_run_; }

 private:
  void declare_rule(Arguments& arguments) {
    DenoiseOptions& options = job_.options;
    arguments.choice("--method", names_of(kOutlierRules),
                     "What tells outliers; see below [statistical]", rule_);
    arguments.option("--knn", "K", "Neighbours that count [statistical: 8; radius: 4]",
                     options.neighbours, parse_integer);
    arguments.option("--multiplier", "N", "statistical: standard deviations beyond the mean [2]",
                     options.multiplier, parse_number);
    arguments.option("--radius", "R",
                     "How far neighbours are looked for [statistical: 10 spacings; radius: 3]",
                     options.radius, parse_positive);
    arguments.option("--h", "H", "residual: width of the fit [2 spacings]", options.h,
                     parse_positive);
    arguments.option("--polynomial-order,--degree", "M", "residual: of the fit, 0 to 4 [3]",
                     options.degree, parse_integer);
    arguments.option("--surface-gate", "F",
                     "residual: the largest residual of a surface, in widths [0.25]", options.gate,
                     parse_positive);
    arguments.flag("--classify", "Keep outliers, as class 7", options.classify);
    arguments.flag("--high", "With --classify: those above their neighbours as class 18",
                   options.high);
    arguments.option("--outputs", "measured", "Add the value that decided as an attribute",
                     options.measured, parse_outputs_word);
  }

  Result<void> estimate(const ReportFile& file, MemoryBudget& budget, Progress& progress) {
    PSS_ASSIGN(const JobEstimate estimate, estimate_denoise(job_, budget, progress));
    return tell_estimate(file, estimate_text(estimate), estimate_json("denoise", estimate).dump(2));
  }

  std::vector<std::string> inputs_;
  DenoiseJob job_;
  std::string rule_;  // empty: not given
  GridOptions grid_;
  LimitOptions limits_;
  ReportOptions reports_;
  bool dry_run_ = false;
};

}  // namespace

std::unique_ptr<Command> make_denoise() { return std::make_unique<Denoise>(); }

}  // namespace pss
