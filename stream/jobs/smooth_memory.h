#pragma once
// What a smoothing job needs of the memory limit before it begins.

#include <cstdint>

#include "stream/jobs/smooth.h"
#include "stream/store/input_memory.h"

namespace pss {

/// The most that a stage of the job has at once, beside its input's head: of these rows and so many
/// points. How dense the points are is known once they are sorted; a dense place may need more.
std::uint64_t least_smooth_memory(const SmoothJob& job, const StoreHeader& header,
                                  std::uint64_t points);

/// reserve_inputs() for files, reserve_header_and_head() for a store, and in both cases the check
/// that the job's stages have what they need.
Result<Reservation> reserve_inputs(const SmoothJob& job, MemoryBudget& budget);

/// check_least() for the job.
Result<void> check_least(const SmoothJob& job, const StoreHeader& header, std::uint64_t points,
                         const MemoryBudget& budget);

}  // namespace pss
