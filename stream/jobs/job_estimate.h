#pragma once
// What a job would take: `--dry-run`.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/jobs/job_kind.h"
#include "stream/jobs/job_request.h"
#include "stream/limit/memory.h"

namespace pss {

/// From a store, the first pass exactly to a block, and all others as it lets expect; from files
/// estimated by their headers.
struct JobEstimate {
  bool from_store = false;
  std::uint64_t points = 0;
  std::uint64_t tiles = 0;
  std::uint64_t parts = 0;
  double halo_share = 0;          ///< halo points over own points
  std::uint64_t peak_memory = 0;  ///< of the process
  std::uint64_t disk_bytes = 0;   ///< work directory and output together, at the worst moment
  double seconds = 0;             ///< of this machine and thread count
};

/// Makes and changes nothing. Errors: those of run_job() before anything is sorted.
Result<JobEstimate> estimate_job(const JobRequest& request, JobKind& kind, MemoryBudget& budget,
                                 Monitor& monitor);

/// Keys as docs/report.md has them.
nlohmann::ordered_json estimate_json(std::string_view command, const JobEstimate& estimate);

}  // namespace pss
