#pragma once
// The job without a pass: files in, the store of their sorted points out, to be used many times.

#include <optional>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/jobs/job_report.h"
#include "stream/jobs/job_request.h"
#include "stream/limit/memory.h"

namespace pss {

/// Requires of a request: files as inputs, NAME.pss as output, no scale or offset of a LAS output.
struct TileJob : JobRequest {
  std::optional<World3> lattice_step;  ///< of the store; default: what suits all inputs
};

/// Runs the job, or goes on with it, or says that it is complete.
///
/// Errors: those of run_job().
Result<JobReport> tile(const TileJob& job, MemoryBudget& budget, Monitor& monitor);

/// The report of a tile job as JSON; keys are documented in docs/report.md and stable.
std::string tile_json(const JobReport& report);

}  // namespace pss
