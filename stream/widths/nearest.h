#pragma once
// The nearest positions of a whole store, for few queries: nearest block first, no cap.

#include <cstdint>
#include <list>
#include <vector>

#include "core/nearest_positions.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/exclusion.h"
#include "stream/store/store.h"

namespace pss {

/// Searches a store from its disk, holding only some blocks. Excluded points are not found.
///
/// Thread: one.
class NearestSearch {
 public:
  NearestSearch(const Store& store, MemoryBudget& budget);

  /// The `count` distinct positions that are nearest to one, its own excluded, in the order of
  /// Neighbour; all, where there are fewer.
  ///
  /// Source: best-first search over boxes, Hjaltason, Samet, "Distance Browsing in Spatial
  /// Databases", 1999.
  Result<std::vector<Neighbour>> nearest(const Index3& query, std::size_t count);

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
