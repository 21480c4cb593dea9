#pragma once
// How much disk a job takes: what is refused before it computes, and what --dry-run tells.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "stream/jobs/job_kind.h"
#include "stream/jobs/job_request.h"
#include "stream/store/store.h"

namespace pss {

/// About how many bytes a job writes, and when it gives them back.
struct JobSpace {
  std::uint64_t sorted = 0;           ///< the sorted input, where the job makes it
  std::vector<std::uint64_t> passes;  ///< the stores to be written; the last one is the result
  std::uint64_t output = 0;           ///< not compressed; none where the output is the result
  bool keeps_sources = false;         ///< all but the result stay, too, while the output is written

  /// Of runs, stores and output together, at the worst moment.
  std::uint64_t most() const;
  /// What must be free once the input is sorted: for the stores, and for the output if it goes to
  /// the same disk.
  std::uint64_t most_more(bool with_output) const;
};

/// Points as a store keeps them.
struct StoredPoints {
  std::uint64_t points = 0;
  std::uint64_t bytes = 0;  ///< on disk
  StoreShape shape;
};
StoredPoints stored_points(const Store& store);

/// Of passes that leave stores of these shapes, each with the points of `source`. New columns and
/// the bits that refine positions count in full: little of them compresses.
JobSpace job_space(const JobRequest& request, const StoredPoints& source,
                   std::span<const StoreShape> passes);

/// Refuses what would fill a disk: the stores that are still to be written must fit on the work
/// directory's, beside the `present` bytes that they have already, and the output on its own, which
/// may be the same. Errors: kFailed.
Result<void> check_space(const JobRequest& request, const JobSpace& space, std::uint64_t present);

}  // namespace pss
