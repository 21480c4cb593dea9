// pss smooth: every point projected onto its MLS surface, out of core.

#include "stream/jobs/smooth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "apps/command.h"
#include "apps/estimate_text.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/report_file.h"
#include "apps/smooth_text.h"
#include "apps/standard_streams.h"
#include "core/parallel.h"
#include "core/simd/targets.h"
#include "io/inputs.h"

namespace pss {

namespace {

constexpr const char* kEpilogue =
    "Lengths are in the scan's units. A point's neighbours are all points within the support\n"
    "radius R; their Gaussian weight of width h reaches zero there. Without --radius, --h and\n"
    "--knn, h is 2 to 6 times the spacing that pss measures, as its noise and shape ask, and\n"
    "R = 3 h (4 h for order 4).\n"
    "Operators: levin finds a reference plane by Newton's method and fits a polynomial over it: a\n"
    "true projection (projecting twice changes nothing), smooths edges. fast iterates a weighted\n"
    "plane instead: quicker, the same surface to a small fraction of the spacing. apss fits\n"
    "spheres: robust where points are few or the surface bends much. rimls keeps sharp features\n"
    "and resists outliers. apss and rimls need normals: those of the input (NormalX NormalY\n"
    "NormalZ, in PLY nx ny nz) are taken as oriented; where it has none, a first pass over all\n"
    "points computes them with levin.\n"
    "A point whose surface is not determined stays where it is; --outputs status says why.\n"
    "Where an input has an attribute that --outputs would write, such as the normals of an\n"
    "earlier run, the job is refused before it begins; --replace-attributes lets the output take\n"
    "its place.\n"
    "Interrupted or killed, the same command goes on where it stopped, and ends with the same\n"
    "bytes; they depend on neither threads, memory limit nor tile size.\n"
    "The page docs/report.md lies in share/doc/pss where pss is installed.\n\n"
    "Examples:\n"
    "  pss smooth scan.las -o smooth.las\n"
    "  pss smooth tiles/ -o all.las --radius 0.3 --memory-limit 4G --report report.json\n"
    "  pss smooth scan.ply -o smooth.ply --knn 40 --outputs normals,curvature\n"
    "  pss smooth scan.pss -o smooth.las --dry-run";

constexpr std::array kPrecisions{Precision::kSingle, Precision::kDouble};

std::vector<std::string> target_names() {
  std::vector<std::string> names;
  for (const simd::Target& target : simd::targets()) names.push_back(target.name);
  return names;
}

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
    PSS_TRY(take_method());
    grid_.put_into(job_);
    job_.state_folder = state_folder();
    Progress progress(reports_.progress);  // from here on a signal ends it in order
    PSS_ASSIGN(const ReportFile report,
               ReportFile::claim(reports_.report, "smooth", job_, inputs_));
    ThreadLimit threads(limits_.threads);
    std::optional<simd::ForcedTarget> forced;
    for (const simd::Target& target : simd::targets())
      if (target.name == target_) forced.emplace(target);
    MemoryBudget budget(limit, thread_count());
    if (dry_run_) return estimate(report, budget, progress);
    PSS_ASSIGN(const SmoothReport done, smooth(job_, budget, progress));
    for (const std::string& line : summary_lines(done)) progress.note(line);
    return report.write(to_json(done));
  }

  bool resumable() const override { return !dry_run_; }

 private:
  void declare_surface(Arguments& arguments) {
    SmoothOptions& options = job_.options;
    WidthOptions& widths = options.widths;
    arguments.option("--radius", "R",
                     "Support radius: weights reach zero there [3 h; order 4: 4 h; weight pcl: h]",
                     widths.radius, parse_positive);
    arguments.option("--h", "H", "Width of the Gaussian [2 to 6 spacings, measured]", widths.h,
                     parse_positive);
    arguments.option("--knn", "K",
                     "Each point owns its radius: the distance to its K-th neighbour, at most "
                     "--radius [10 spacings]",
                     widths.knn, parse_integer);
    arguments.option("--polynomial-order,--degree", "M",
                     "Degree of the local surface of levin and fast, 0 to 4 [3]", degree_,
                     parse_integer);
    declare_method(arguments);
    arguments.option("--outputs", "LIST",
                     "Attributes to add: normals, curvature, principal (curvatures and direction), "
                     "displacement, residual, neighbors, boundary, status, all",
                     options.outputs, parse_outputs_word);
    arguments.flag("--replace-attributes",
                   "Let outputs take the place of the input's attributes of the same name",
                   options.replace_attributes);
    arguments.option("--buffer", "B",
                     "Halo width by hand; less than exactness needs is refused [what is needed]",
                     options.buffer, parse_positive);
    arguments.flag("--allow-inexact", "Take a --buffer that is too narrow: radii shrink to it",
                   options.allow_inexact);
    declare_drop_outside(arguments, job_.drop_outside);
    grid_.declare(arguments);
  }

  void declare_method(Arguments& arguments) {
    arguments.choice("--operator", names_of(kMlsOperators),
                     "How a point finds the surface: a true projection, the same quicker, "
                     "algebraic spheres, or sharp features kept; see below [levin]",
                     operator_);
    arguments.choice("--weight", names_of(kWeightKinds),
                     "Of a neighbour by its distance: a Gaussian tapered to zero at R, Wendland's "
                     "compact polynomial, or exp(-d^2/R^2) cut at R, as PCL has it, to compare "
                     "[gaussian]",
                     weight_);
    arguments.choice("--precision", names_of(kPrecisions),
                     "Of the computation; single redoes in double what needs it [single; order 4: "
                     "double]",
                     precision_);
  }

  void declare_how(Arguments& arguments) {
    limits_.declare(arguments);
    declare_work(arguments, job_);
    arguments.flag("--dry-run", "Only tell tiles, halo, memory, disk and time that it would take",
                   dry_run_);
    reports_.declare_progress(arguments);
    reports_.declare_report(arguments);
    declare_tile_points(arguments, job_);
    arguments.choice("--simd", target_names(),
                     "Vector instructions to compute with, for experiments [the widest there are]",
                     target_);
  }

  static Result<OutputSet> parse_outputs_word(std::string_view text) {
    return parse_outputs(std::string(text));
  }

  Result<void> take_method() {
    SmoothOptions& options = job_.options;
    options.op = named(kMlsOperators, operator_).value_or(options.op);
    options.weight = named(kWeightKinds, weight_).value_or(options.weight);
    options.precision = named(kPrecisions, precision_);
    options.widths.degree = degree_.value_or(options.widths.degree);
    if (!degree_ || !needs_normals(options.op)) return {};
    return Error{Fault::kUsage,
                 fmt::format("--polynomial-order has no meaning with --operator {}, which fits no "
                             "polynomial; leave it out",
                             name_of(options.op))};
  }

  Result<void> estimate(const ReportFile& report, MemoryBudget& budget, Progress& progress) {
    PSS_ASSIGN(const SmoothEstimate estimate, estimate_smooth(job_, budget, progress));
    return tell_estimate(report, estimate_text(estimate), to_json(estimate));
  }

  std::vector<std::string> inputs_;
  SmoothJob job_;
  std::string operator_, weight_, precision_, target_;  // empty: not given
  std::optional<int> degree_;
  GridOptions grid_;
  LimitOptions limits_;
  ReportOptions reports_;
  bool dry_run_ = false;
};

}  // namespace

std::unique_ptr<Command> make_smooth() { return std::make_unique<Smooth>(); }

}  // namespace pss
