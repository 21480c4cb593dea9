#pragma once
// Reads a whole store and checks everything in it: checksums, counts, boxes, order, tiling.

#include <cstdint>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/file/hash.h"
#include "stream/limit/memory.h"

namespace pss {

struct VerifySummary {
  std::uint64_t tiles = 0;
  std::uint64_t blocks = 0;
  std::uint64_t points = 0;
  std::uint64_t bytes = 0;
  bool complete = false;  ///< whether the writer finished it
  Hash128 rows;           ///< of positions and rows in order; independent of tiles and blocks
  /// What is wrong, each with file and offset; no more than kMostDamage.
  std::vector<std::string> damage;
  std::uint64_t damage_count = 0;  ///< all that is wrong

  bool sound() const { return damage_count == 0; }
};

inline constexpr std::size_t kMostDamage = 20;

/// Checks a store to its end, whatever is wrong on the way.
///
/// Errors: kBadInput where the manifest cannot be read, kFailed where there is no store,
///         kMemoryLimit, kInterrupted. Damage to tiles is no error but in the summary.
Result<VerifySummary> verify_store(const std::string& path, MemoryBudget& budget, Monitor& monitor);

/// Reads a finished store's bytes against their checksums, decoding none.
///
/// Errors: kBadInput, with file and offset, where it is not there as it was written; kFailed for
///         I/O, kInterrupted.
/// Cost:   memory for its tables and one column of a block.
Result<void> check_bytes(const std::string& path, Monitor& monitor);

}  // namespace pss
