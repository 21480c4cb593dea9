#include "stream/jobs/smooth.h"

#include <utility>

#include "stream/jobs/run_job.h"
#include "stream/jobs/smooth_kind.h"

namespace pss {

Result<SmoothReport> smooth(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor) {
  SmoothKind kind(job);
  PSS_ASSIGN(JobReport done, run_job(job, kind, budget, monitor));
  return SmoothReport{std::move(done), kind.choices(), kind.statistics()};
}

Result<SmoothEstimate> estimate_smooth(const SmoothJob& job, MemoryBudget& budget,
                                       Monitor& monitor) {
  SmoothKind kind(job);
  PSS_ASSIGN(const JobEstimate estimate, estimate_job(job, kind, budget, monitor));
  return SmoothEstimate{estimate, kind.choices()};
}

}  // namespace pss
