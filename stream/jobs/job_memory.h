#pragma once
// What a job needs of the memory limit before it begins.

#include <cstddef>
#include <cstdint>

#include "stream/jobs/job_kind.h"
#include "stream/jobs/job_request.h"
#include "stream/store/input_memory.h"

namespace pss {

/// The most that a stage of the job has at once, beside its input's head: of these rows and so many
/// points, read from files with so large a Reader::unit(). How dense the points are is known once
/// they are sorted; a dense place may need more.
std::uint64_t least_job_memory(const JobRequest& request, const JobKind& kind,
                               const StoreHeader& header, std::uint64_t points, std::size_t unit);

/// reserve_inputs() for files, reserve_header_and_head() for a store, and in both cases the check
/// that the job's stages have what they need.
Result<Reservation> reserve_inputs(const JobRequest& request, const JobKind& kind,
                                   MemoryBudget& budget);

/// check_least() for the job.
Result<void> check_least(const JobRequest& request, const JobKind& kind, const StoreHeader& header,
                         std::uint64_t points, std::size_t unit, const MemoryBudget& budget);

}  // namespace pss
