#pragma once
// The main job: files or a store in, every point projected onto its MLS surface, one file out.

#include <optional>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/jobs/job_estimate.h"
#include "stream/jobs/job_report.h"
#include "stream/jobs/job_request.h"
#include "stream/limit/memory.h"
#include "stream/operators/project_statistics.h"
#include "stream/passes/normals.h"
#include "stream/passes/outputs.h"
#include "stream/widths/widths.h"

namespace pss {

/// What the user asked of the projection; what is empty is chosen and explained in the report.
struct SmoothOptions {
  MlsOperator op = MlsOperator::kLevin;
  WeightKind weight = WeightKind::kGaussian;
  std::optional<Precision> precision;
  WidthOptions widths;  ///< their degree is that of the polynomial, where the operator has one
  OutputSet outputs = 0;
  bool replace_attributes = false;  ///< outputs may take the place of attributes of the inputs
  std::optional<double> buffer;
  bool allow_inexact = false;
};

struct SmoothJob : JobRequest {
  SmoothOptions options;
};

/// What a projection was done with.
struct SmoothChoices {
  Method method;
  NormalsFrom normals = NormalsFrom::kNowhere;
  ChosenWidths widths;
};

struct SmoothReport : JobReport {
  SmoothChoices choices;
  ProjectStatistics statistics;
};

/// The report as JSON; keys are documented in docs/report.md and stable.
std::string to_json(const SmoothReport& report);

/// Runs the job, or goes on with it, or says that it is complete.
///
/// Errors: those of run_job().
Result<SmoothReport> smooth(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor);

/// What a job would take; the widths are those of a store, or as far as known before the sorting.
struct SmoothEstimate : JobEstimate {
  SmoothChoices choices;
};
Result<SmoothEstimate> estimate_smooth(const SmoothJob& job, MemoryBudget& budget,
                                       Monitor& monitor);
std::string to_json(const SmoothEstimate& estimate);

}  // namespace pss
