#pragma once
// Removes or classifies the outliers of a scan: points that have too little around them.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/method.h"
#include "core/monitor.h"
#include "core/result.h"
#include "stream/jobs/job_estimate.h"
#include "stream/jobs/job_report.h"
#include "stream/jobs/job_request.h"
#include "stream/limit/memory.h"
#include "stream/operators/measure.h"
#include "stream/operators/select.h"

namespace pss {

/// What tells outliers from other points.
enum class OutlierRule : std::uint8_t {
  kStatistical,  ///< a mean distance to the k nearest points far above that of the whole scan
  kRadius,       ///< fewer than k points within a radius
  kResidual,     ///< no surface, or one from which the neighbours lie far off
};
inline constexpr std::array kOutlierRules{OutlierRule::kStatistical, OutlierRule::kRadius,
                                          OutlierRule::kResidual};
/// "statistical", "radius", "residual".
const char* name_of(OutlierRule rule);

/// What the user asked for; what is empty is chosen and explained in the report.
struct DenoiseOptions {
  OutlierRule rule = OutlierRule::kStatistical;
  std::optional<int> neighbours;     ///< k [statistical 8, radius 4]
  std::optional<double> multiplier;  ///< of the standard deviation, beyond the mean [2]
  std::optional<double> radius;      ///< how far it is looked [spacings: statistical 10, radius 3]
  std::optional<double> h;           ///< width of the fit [2 spacings]
  std::optional<int> degree;         ///< of the fit [3]
  std::optional<double> gate;        ///< the largest residual of a surface, over h [0.25]
  bool classify = false;             ///< outliers stay, as class 7
  bool high = false;                 ///< those above their neighbours as class 18
  bool measured = false;             ///< the measured value becomes an attribute
};

struct DenoiseJob : JobRequest {
  DenoiseOptions options;
};

/// What it was decided by, and what became of the points.
struct DenoiseChoices {
  std::string why;            ///< sentences for the report
  double radius = 0;          ///< how far was looked
  double h = 0;               ///< residual: the width of the fit
  double mean = 0;            ///< statistical: over all points that have k within the radius
  double deviation = 0;       ///< statistical: likewise, n - 1
  double threshold = 0;       ///< of the measured value: beyond it a point is an outlier
  std::uint64_t nothing = 0;  ///< points without a value: outliers all
};

struct DenoiseReport : JobReport {
  DenoiseOptions options;
  DenoiseChoices choices;
  SelectionCounts counts;
};

/// The report as JSON; keys are documented in docs/report.md and stable.
std::string to_json(const DenoiseReport& report);

/// Runs the job, or goes on with it, or says that it is complete.
///
/// Errors: those of run_job().
Result<DenoiseReport> denoise(const DenoiseJob& job, MemoryBudget& budget, Monitor& monitor);

/// What a job would take.
Result<JobEstimate> estimate_denoise(const DenoiseJob& job, MemoryBudget& budget, Monitor& monitor);

}  // namespace pss
