#include "stream/jobs/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/support.h"
#include "stream/jobs/calibration.h"
#include "stream/jobs/job_kind.h"
#include "stream/jobs/parameters_json.h"
#include "stream/jobs/run_job.h"
#include "stream/operators/measure.h"
#include "stream/operators/select.h"
#include "stream/widths/spacing.h"
#include "stream/widths/width_trials.h"

namespace pss {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* kMeasuring = "measure";
constexpr const char* kSelecting = "select";
constexpr std::uint8_t kLowNoise = 7;    ///< LAS: low point (noise)
constexpr std::uint8_t kHighNoise = 18;  ///< LAS: high noise
constexpr double kMultiplier = 2;
constexpr double kGate = 0.25;
/// Radii in spacings where none is given.
constexpr double kStatisticalCap = 10;
constexpr double kCountingRadius = 3;
constexpr double kFitWidth = 2;
// What --dry-run reckons with, of one thread: a point whose neighbours are looked for, and each.
constexpr double kSearchSeconds = 1e-6;
constexpr double kNeighbourSeconds = 0.15e-6;
constexpr double kUsualNeighbours = 113;  ///< at h = 2 spacings

/// The attribute of a measured value.
const char* attribute_of(OutlierRule rule) {
  constexpr std::array kNames{"MeanDistance", "NeighborCount", "FitResidual"};
  return kNames[static_cast<std::size_t>(rule)];
}

Result<void> check_meaning(OutlierRule rule, bool given, const char* flag, bool has_meaning) {
  if (!given || has_meaning) return {};
  return Error{Fault::kUsage, fmt::format("{} has no meaning with --method {}; leave it out", flag,
                                          name_of(rule))};
}

Result<void> check_positive(const std::optional<double>& value, const char* flag) {
  if (!value || (*value > 0 && std::isfinite(*value))) return {};
  return Error{Fault::kUsage, fmt::format("{}: found {}, expected a number above 0", flag, *value)};
}

/// The longest side of all tiles' box, or 1 where that is nothing.
double extent_of(const Source& source) {
  IndexBox box;
  for (const TileInfo& tile : source.tiles()) box.add(tile.box);
  double longest = 0;
  for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
    longest =
        std::max(longest, source.lattice().scale[a] * static_cast<double>(box.max[a] - box.min[a]));
  return longest > 0 ? longest : 1;
}

class DenoiseKind : public JobKind {
 public:
  explicit DenoiseKind(const DenoiseJob& job) : job_(job), options_(job.options) {}

  std::string_view command() const override { return "denoise"; }
  json parameters() const override;
  PassNames passes() const override { return {{kMeasuring, kSelecting}}; }
  Result<void> check() const override;
  Result<Schema> result_schema(const Schema& source) const override {
    return selected_schema(source, selection());
  }
  Result<void> check_source(const Schema& source) const override {
    PSS_TRY(result_schema(source));
    return {};
  }
  std::uint64_t measuring_memory() const override { return needs_spacing() ? width_memory() : 0; }
  Result<std::optional<Pass>> next(PassContext& job) override;
  void remember(ordered_json& summary) const override;
  void recall(const ordered_json& summary) override;
  Result<void> look_at(const Store& result, JobReport& report) override;
  std::vector<StoreShape> expect(const StoreHeader& source) override;
  double seconds_per_point() const override;

  const DenoiseChoices& choices() const { return choices_; }
  const SelectionCounts& counts() const { return counts_; }

 private:
  bool needs_spacing() const {
    if (options_.rule == OutlierRule::kResidual) return !options_.h;
    return options_.rule == OutlierRule::kStatistical || !options_.radius;
  }
  int neighbours() const {
    return options_.neighbours.value_or(options_.rule == OutlierRule::kRadius ? 4 : 8);
  }
  double multiplier() const { return options_.multiplier.value_or(kMultiplier); }
  double gate() const { return options_.gate.value_or(kGate); }
  Method method() const {
    return {.op = MlsOperator::kFast, .degree = options_.degree.value_or(3)};
  }
  Selection selection() const;
  Result<void> choose_radius(const Source& source, PassContext& job);
  std::unique_ptr<const MeasureOperator> measuring(const Source& source,
                                                   const PassContext& job) const;
  std::string record(const PassContext& job) const;
  void choose_threshold(const MeasurementSums& sums);
  Result<Pass> measure(PassContext& job);
  Result<Pass> select(PassContext& job);

  const DenoiseJob& job_;
  const DenoiseOptions& options_;
  DenoiseChoices choices_;
  SelectionCounts counts_;
  double guess_ = 0;    ///< a typical distance to the k-th nearest
  double quantum_ = 1;  ///< of measured values
};

/// What has no meaning for the rule is null; what is not given has its default.
json DenoiseKind::parameters() const {
  const bool statistical = options_.rule == OutlierRule::kStatistical;
  const bool residual = options_.rule == OutlierRule::kResidual;
  json parameters = {{"method", name_of(options_.rule)},
                     {"knn", residual ? json() : json(neighbours())},
                     {"multiplier", statistical ? json(multiplier()) : json()},
                     {"radius", optional_json(options_.radius)},
                     {"h", optional_json(options_.h)},
                     {"polynomial-order", residual ? json(method().degree) : json()},
                     {"surface-gate", residual ? json(gate()) : json()},
                     {"classify", options_.classify},
                     {"high", options_.high},
                     {"outputs", options_.measured ? json{"measured"} : json::array()}};
  add_grid_json(job_, parameters);
  return parameters;
}

Result<void> DenoiseKind::check() const {
  const OutlierRule rule = options_.rule;
  const bool statistical = rule == OutlierRule::kStatistical;
  const bool residual = rule == OutlierRule::kResidual;
  PSS_TRY(check_meaning(rule, options_.neighbours.has_value(), "--knn", !residual));
  PSS_TRY(check_meaning(rule, options_.multiplier.has_value(), "--multiplier", statistical));
  PSS_TRY(check_meaning(rule, options_.h.has_value(), "--h", residual));
  PSS_TRY(check_meaning(rule, options_.degree.has_value(), "--polynomial-order", residual));
  PSS_TRY(check_meaning(rule, options_.gate.has_value(), "--surface-gate", residual));
  PSS_TRY(check_meaning(rule, residual && options_.radius.has_value(), "--radius", false));
  PSS_TRY(check_positive(options_.radius, "--radius"));
  PSS_TRY(check_positive(options_.h, "--h"));
  PSS_TRY(check_positive(options_.gate, "--surface-gate"));
  if (options_.multiplier && !(*options_.multiplier >= 0 && std::isfinite(*options_.multiplier)))
    return Error{Fault::kUsage, fmt::format("--multiplier: found {}, expected a number not below 0",
                                            *options_.multiplier)};
  if (neighbours() < 1) return Error{Fault::kUsage, "--knn: expected at least 1"};
  if (method().degree > 4)
    return Error{Fault::kUsage,
                 fmt::format("--polynomial-order: found {}, expected 0 to 4", method().degree)};
  if (options_.high && !options_.classify)
    return Error{Fault::kUsage,
                 "--high has no meaning without --classify; leave it out, or give "
                 "both"};
  return {};
}

Selection DenoiseKind::selection() const {
  Selection selection;
  selection.classify = options_.classify;
  selection.low = kLowNoise;
  selection.high = options_.high ? kHighNoise : kLowNoise;
  if (options_.measured) selection.output = attribute_of(options_.rule);
  selection.quantum = quantum_;
  return selection;
}

/// Without a spacing, of fewer than 17 positions, it is looked as far as there are points.
Result<void> DenoiseKind::choose_radius(const Source& source, PassContext& job) {
  double spacing = 0;
  if (needs_spacing()) {
    const StageTimer timer("spacing", job.report.stages);
    PSS_ASSIGN(const std::optional<Spacing> measured,
               measure_spacing(source, job.budget, job.monitor));
    spacing = measured ? measured->spacing : 0;
  }
  const bool residual = options_.rule == OutlierRule::kResidual;
  const double factor = residual                                     ? kFitWidth
                        : options_.rule == OutlierRule::kStatistical ? kStatisticalCap
                                                                     : kCountingRadius;
  const double chosen = spacing > 0 ? factor * spacing : extent_of(source);
  choices_.h = residual ? options_.h.value_or(chosen) : 0;
  choices_.radius =
      residual ? support_of_h(choices_.h, method()).radius : options_.radius.value_or(chosen);
  guess_ = std::min(choices_.radius,
                    spacing > 0 ? spacing * std::sqrt(neighbours() / 3.0) : choices_.radius);
  choices_.why = spacing > 0 ? fmt::format("the measured spacing is {:.3g}; looks {:.4g} far",
                                           spacing, choices_.radius)
                             : fmt::format("looks {:.4g} far", choices_.radius);
  job.monitor.note(choices_.why);
  return {};
}

std::string DenoiseKind::record(const PassContext& job) const {
  return owned_by(job.identity, {{"method", name_of(options_.rule)},
                                 {"knn", neighbours()},
                                 {"radius", choices_.radius},
                                 {"h", choices_.h},
                                 {"threshold", choices_.threshold}});
}

std::unique_ptr<const MeasureOperator> DenoiseKind::measuring(const Source& source,
                                                              const PassContext& job) const {
  const std::string record = this->record(job);
  switch (options_.rule) {
    case OutlierRule::kStatistical:
      return std::make_unique<MeanDistance>(source, neighbours(), choices_.radius, guess_, record);
    case OutlierRule::kRadius:
      return std::make_unique<NeighbourCount>(source, choices_.radius, record);
    default:
      return std::make_unique<FitResidual>(source, method(), support_of_h(choices_.h, method()),
                                           record);
  }
}

void DenoiseKind::choose_threshold(const MeasurementSums& sums) {
  choices_.nothing = sums.nothing;
  if (options_.rule == OutlierRule::kRadius) {
    choices_.threshold = neighbours();
  } else if (options_.rule == OutlierRule::kResidual) {
    choices_.threshold = gate();
  } else {
    choices_.mean = sums.values.mean() * quantum_;
    choices_.deviation = sums.values.deviation() * quantum_;
    choices_.threshold = choices_.mean + multiplier() * choices_.deviation;
  }
}

Result<std::optional<Pass>> DenoiseKind::next(PassContext& job) {
  if (job.done.size() == 2) return std::optional<Pass>();
  PSS_ASSIGN(Pass pass, job.done.empty() ? measure(job) : select(job));
  return std::optional(std::move(pass));
}

Result<Pass> DenoiseKind::measure(PassContext& job) {
  PSS_ASSIGN(std::unique_ptr<PassSource> source, job.open_input());
  PSS_TRY(choose_radius(source->points(), job));
  PSS_ASSIGN(const Schema result, result_schema(source->points().schema()));
  const StoreShape later{source->points().lattice(), result.row_size()};
  std::unique_ptr<const MeasureOperator> op = measuring(source->points(), job);
  quantum_ = op->quantum();
  return Pass{
      .name = kMeasuring, .queries = std::move(source), .op = std::move(op), .later = {later}};
}

/// Of a count those below the threshold are outliers; of all else those above it.
Result<Pass> DenoiseKind::select(PassContext& job) {
  choose_threshold(MeasurementSums::from_bytes(job.done.back().note.bytes));
  PSS_ASSIGN(std::unique_ptr<PassSource> source, job.open_input());
  PSS_TRY(job.join(*source, kMeasuring));
  Selection selection = this->selection();
  const double most = std::min(std::floor(choices_.threshold / quantum_), kNothingMeasured - 1.0);
  if (options_.rule == OutlierRule::kRadius)
    selection.least = static_cast<std::uint32_t>(neighbours());
  else
    selection.most = static_cast<std::uint32_t>(most);
  selection.record = record(job);
  PSS_ASSIGN(SelectOperator op, SelectOperator::create(source->points(), selection));
  return Pass{.name = kSelecting,
              .queries = std::move(source),
              .op = std::make_unique<SelectOperator>(std::move(op))};
}

void DenoiseKind::remember(ordered_json& summary) const {
  summary["denoise"] = {{"why", choices_.why},
                        {"radius", choices_.radius},
                        {"h", choices_.h},
                        {"mean", choices_.mean},
                        {"deviation", choices_.deviation},
                        {"threshold", choices_.threshold},
                        {"nothing", choices_.nothing}};
}

void DenoiseKind::recall(const ordered_json& summary) {
  const ordered_json j = summary.value("denoise", ordered_json::object());
  choices_.why = j.value("why", "");
  choices_.radius = j.value("radius", 0.0);
  choices_.h = j.value("h", 0.0);
  choices_.mean = j.value("mean", 0.0);
  choices_.deviation = j.value("deviation", 0.0);
  choices_.threshold = j.value("threshold", 0.0);
  choices_.nothing = j.value("nothing", std::uint64_t{0});
}

Result<void> DenoiseKind::look_at(const Store& result, JobReport& report) {
  PSS_ASSIGN(counts_, SelectionCounts::from_note(result.note(), result.path()));
  const std::uint64_t looked = counts_.kept + counts_.outliers();
  if (2 * counts_.outliers() > looked)
    report.notes.push_back(fmt::format(
        "{} of {} points are outliers by this rule: --radius, --knn and --method decide it",
        counts_.outliers(), looked));
  return {};
}

std::vector<StoreShape> DenoiseKind::expect(const StoreHeader& source) {
  const Result<Schema> schema = result_schema(source.schema);
  return {{source.lattice, measurement_schema().row_size(), true},
          {source.lattice, (schema ? *schema : source.schema).row_size()}};
}

double DenoiseKind::seconds_per_point() const {
  switch (options_.rule) {
    case OutlierRule::kStatistical:
      return kSearchSeconds + neighbours() * kNeighbourSeconds;
    case OutlierRule::kRadius:
      return kSearchSeconds;
    default:
      return pss::seconds_per_point(method(), kUsualNeighbours);
  }
}

}  // namespace

const char* name_of(OutlierRule rule) {
  constexpr std::array kNames{"statistical", "radius", "residual"};
  return kNames[static_cast<std::size_t>(rule)];
}

Result<DenoiseReport> denoise(const DenoiseJob& job, MemoryBudget& budget, Monitor& monitor) {
  DenoiseKind kind(job);
  PSS_ASSIGN(JobReport done, run_job(job, kind, budget, monitor));
  return DenoiseReport{std::move(done), job.options, kind.choices(), kind.counts()};
}

Result<JobEstimate> estimate_denoise(const DenoiseJob& job, MemoryBudget& budget,
                                     Monitor& monitor) {
  DenoiseKind kind(job);
  return estimate_job(job, kind, budget, monitor);
}

std::string to_json(const DenoiseReport& report) {
  ordered_json j = head_json(report);
  if (report.already_complete) return report_text(j);
  const DenoiseChoices& choices = report.choices;
  j["points"] = {{"in", report.points_in},
                 {"out", report.points_out},
                 {"dropped",
                  {{"not_finite", report.ingest.dropped_not_finite},
                   {"outside", report.ingest.dropped_outside},
                   {"outliers", report.options.classify ? 0 : report.counts.outliers()}}},
                 {"outliers",
                  {{"low", report.counts.low},
                   {"high", report.counts.high},
                   {"without_value", choices.nothing}}},
                 {"excluded", report.counts.excluded}};
  j["method"] = {{"name", name_of(report.options.rule)},
                 {"radius", choices.radius},
                 {"h", choices.h},
                 {"mean", choices.mean},
                 {"deviation", choices.deviation},
                 {"threshold", choices.threshold},
                 {"why", choices.why}};
  j["rounding_step"] = report.rounding_step;
  j["tiles"] = report.tiles;
  add_tail_json(report, j);
  return report_text(j);
}

}  // namespace pss
