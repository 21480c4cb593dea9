// pss smooth: every point projected onto its MLS surface, out of core.

#include "stream/smooth.h"

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/smooth_text.h"
#include "core/parallel.h"
#include "io/inputs.h"

namespace pss {

namespace {

constexpr const char* kEpilogue =
    "Lengths are in the scan's units. A point's neighbours are all points within the support\n"
    "radius R; their Gaussian weight of width h reaches zero there. Without --radius, --h and\n"
    "--knn, h is twice the spacing that pss measures, and R = 3 h (4 h for order 4).\n"
    "A point whose surface is not determined stays where it is; --outputs status says why.\n"
    "Interrupted or killed, the same command goes on where it stopped, and ends with the same\n"
    "bytes; they depend on neither threads, memory limit nor tile size.\n\n"
    "Examples:\n"
    "  pss smooth scan.las -o smooth.las\n"
    "  pss smooth tiles/ -o all.las --radius 0.3 --memory-limit 4G --report report.json\n"
    "  pss smooth scan.ply -o smooth.ply --knn 40 --outputs normals,curvature\n"
    "  pss smooth scan.pss -o smooth.las --dry-run";

class Smooth : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positionals("INPUT", "Files, directories, globs, @list.txt, or one store NAME.pss",
                          inputs_);
    arguments.option("-o,--output", "OUTPUT",
                     "A file (the extension says the format), or NAME.pss to keep the store "
                     "(required)",
                     job_.output, parse_output);
    arguments.required();
    declare_surface(arguments);
    declare_how(arguments);
    arguments.epilogue(kEpilogue);
  }

  Result<void> run() override {
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    PSS_ASSIGN(job_.inputs, expand_inputs(inputs_, job_.output));
    PSS_TRY(reports_.check());
    take_options();
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    Progress progress(reports_.progress);
    if (dry_run_) return estimate(budget, progress);
    PSS_ASSIGN(const SmoothReport report, smooth(job_, budget, progress));
    for (const std::string& line : summary_lines(report)) progress.note(line);
    return reports_.write(to_json(report));
  }

  bool resumable() const override { return !dry_run_; }

 private:
  void declare_surface(Arguments& arguments) {
    SmoothOptions& options = job_.options;
    WidthOptions& widths = options.widths;
    arguments.option("--radius", "R",
                     "Support radius: weights reach zero there [3 h; order 4: 4 h]", widths.radius,
                     parse_positive);
    arguments.option("--h", "H", "Width of the Gaussian [2 spacings, measured]", widths.h,
                     parse_positive);
    arguments.option("--knn", "K",
                     "Each point owns its radius: the distance to its K-th neighbour, at most "
                     "--radius [10 spacings]",
                     widths.knn, parse_integer);
    arguments.option("--polynomial-order,--degree", "M", "Of the local surface, 0 to 4 [3]",
                     widths.degree, parse_integer);
    arguments.choice("--operator", {"levin"}, "The projection [levin]", operator_);
    arguments.choice("--weight", {"gaussian"}, "The weight, tapered to zero at R [gaussian]",
                     weight_);
    arguments.choice("--precision", {"double"}, "Of the computation [double]", precision_);
    arguments.option("--outputs", "LIST",
                     "Attributes to add: normals, curvature, displacement, residual, neighbors, "
                     "boundary, status, all",
                     options.outputs, parse_outputs_word);
    arguments.option("--buffer", "B",
                     "Halo width by hand; less than exactness needs is refused [what is needed]",
                     options.buffer, parse_positive);
    arguments.flag("--allow-inexact", "Take a --buffer that is too narrow", options.allow_inexact);
    grid_.declare(arguments);
  }

  void declare_how(Arguments& arguments) {
    limits_.declare(arguments);
    directory_.declare(arguments);
    arguments.flag("--dry-run", "Only tell tiles, halo, memory, disk and time that it would take",
                   dry_run_);
    reports_.declare_progress(arguments);
    reports_.declare_report(arguments);
    arguments.option("--tile-points", "N", "Points a tile owns at most, for experiments [262144]",
                     job_.options.tile_points, parse_tile_points);
  }

  static Result<OutputSet> parse_outputs_word(std::string_view text) {
    return parse_outputs(std::string(text));
  }

  void take_options() {
    SmoothOptions& options = job_.options;
    options.scale = grid_.scale.steps;
    options.scale_auto = grid_.scale.automatic;
    options.offset = grid_.offset;
    options.work_dir = directory_.work_dir;
    options.overwrite = directory_.overwrite;
    options.restart = directory_.restart;
    options.keep_work = directory_.keep_work;
  }

  Result<void> estimate(MemoryBudget& budget, Progress& progress) {
    PSS_ASSIGN(const SmoothEstimate estimate, estimate_smooth(job_, budget, progress));
    fmt::print("{}", estimate_text(estimate));
    return reports_.write(to_json(estimate));
  }

  std::vector<std::string> inputs_;
  SmoothJob job_;
  std::string operator_, weight_, precision_;  // one choice each for now
  GridOptions grid_;
  JobOptions directory_;
  LimitOptions limits_;
  ReportOptions reports_;
  bool dry_run_ = false;
};

}  // namespace

std::unique_ptr<Command> make_smooth() { return std::make_unique<Smooth>(); }

}  // namespace pss
