#pragma once
// The nearest positions of a whole source, for few queries: nearest block first, no cap.

#include <cstdint>
#include <list>
#include <vector>

#include "core/nearest_positions.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/box_tree.h"
#include "stream/passes/index_cache.h"
#include "stream/passes/source.h"

namespace pss {

/// Searches a source from its disk, holding only some blocks. Excluded points are not found.
///
/// Thread: one.
class NearestSearch {
 public:
  NearestSearch(const Source& source, MemoryBudget& budget);

  /// The `count` distinct positions that are nearest to one, its own excluded, in the order of
  /// Neighbour; all, where there are fewer.
  Result<std::vector<Neighbour>> nearest(const Index3& query, std::size_t count);

 private:
  struct CachedBlock {
    std::uint64_t first_row;
    std::vector<Index3> positions;
  };
  Result<const std::vector<Index3>*> positions_of(std::size_t tile, const BlockInfo& block);

  const Source& source_;
  BoxTree tiles_;
  IndexCache indexes_;
  Reservation memory_;
  std::size_t most_blocks_;
  std::list<CachedBlock> blocks_;  ///< most recently used first
};

}  // namespace pss
