#pragma once
// The k-th nearest position of a whole store, for few queries: nearest block first, no cap.

#include <cstdint>
#include <list>
#include <optional>
#include <vector>

#include "core/result.h"
#include "stream/exclusion.h"
#include "stream/memory.h"
#include "stream/store.h"

namespace pss {

/// Searches a store from its disk, holding only some blocks. Excluded points are not found.
///
/// Thread: one.
class NearestSearch {
 public:
  NearestSearch(const Store& store, MemoryBudget& budget);

  /// The distance from `query` to its k-th nearest distinct position, its own excluded.
  ///
  /// Empty where the store has fewer. Source: best-first search over boxes, Hjaltason, Samet,
  /// "Distance Browsing in Spatial Databases", 1999.
  Result<std::optional<double>> kth_distance(const Index3& query, int k);

 private:
  struct CachedIndex {
    std::size_t tile;
    std::vector<BlockInfo> blocks;
  };
  struct CachedBlock {
    std::uint64_t first_row;
    std::vector<Index3> positions;
  };
  Result<const std::vector<BlockInfo>*> index_of(std::size_t tile);
  Result<const std::vector<Index3>*> positions_of(std::size_t tile, const BlockInfo& block);

  const Store& store_;
  Exclusion exclusion_;
  Reservation memory_;
  std::size_t most_blocks_;
  std::list<CachedIndex> indexes_;  ///< most recently used first
  std::list<CachedBlock> blocks_;   ///< likewise
};

}  // namespace pss
