#pragma once
// How ingest divides what the memory limit leaves: batches, chunks, and how many runs at once.

#include <cstddef>
#include <cstdint>

#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/sort/input_stream.h"
#include "stream/store/manifest.h"

namespace pss {

/// No more records than this may be decoded together: a chunk has room for them.
inline constexpr std::size_t kLargestUnit = std::size_t{1} << 30;

struct IngestMemory {
  Batches batches;                ///< of whole units
  std::size_t chunk_points = 0;   ///< sorted at once
  std::size_t fan_in = 0;         ///< runs merged at once
  std::uint64_t read_bytes = 0;   ///< what reading, sorting and writing a run holds
  std::uint64_t merge_bytes = 0;  ///< what merging up to `fan_in` runs into tiles may hold
  std::uint64_t tile_bytes = 0;   ///< of these, what does not depend on the number of runs
};

/// Shape:    `points` as promised by the inputs; it bounds what is asked for, not what may come.
///           `unit` is the largest Reader::unit() of the inputs.
/// Requires: `unit` from 1 to kLargestUnit.
/// Errors:   kMemoryLimit, with the limit that would do.
Result<IngestMemory> divide_memory(const StoreHeader& header, std::uint64_t points,
                                   std::size_t unit, const MemoryBudget& budget);

/// What must be left of a limit for divide_memory() to succeed.
std::uint64_t least_ingest_memory(const StoreHeader& header, std::uint64_t points,
                                  std::size_t unit);

}  // namespace pss
