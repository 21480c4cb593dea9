#include "stream/widths/nearest.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "stream/widths/distance_filter.h"

namespace pss {
namespace {

constexpr std::size_t kMostIndexes = 32;
constexpr std::size_t kBlockBytes = kBlockPoints * sizeof(Index3);
constexpr std::uint64_t kCacheBytes = 16u << 20;

/// Something that may hold near positions: a tile, or one of its blocks.
struct Place {
  double distance_sq;
  std::size_t tile;
  const BlockInfo* block;  ///< null for a whole tile
  bool operator>(const Place& other) const { return distance_sq > other.distance_sq; }
};

void add(const Lattice& lattice, const Index3& query, const std::vector<Index3>& positions,
         NearestPositions& nearest) {
  for (const Index3& position : positions) {
    if (nearest.full() && surely_farther(lattice, query, position, nearest.largest())) continue;
    if (position != query) nearest.add(distance_sq(lattice, query, position), position);
  }
}

}  // namespace

NearestSearch::NearestSearch(const Store& store, MemoryBudget& budget)
    : store_(store), exclusion_(store.header().schema) {
  const std::uint64_t bytes = std::min<std::uint64_t>(kCacheBytes, budget.available() / 2);
  if (auto memory = budget.reserve(bytes)) memory_ = std::move(*memory);
  most_blocks_ = std::max<std::size_t>(4, memory_.bytes() / kBlockBytes);
}

Result<const std::vector<BlockInfo>*> NearestSearch::index_of(std::size_t tile) {
  const auto found = std::ranges::find(indexes_, tile, &CachedIndex::tile);
  if (found != indexes_.end()) {
    indexes_.splice(indexes_.begin(), indexes_, found);
  } else {
    PSS_ASSIGN(std::vector<BlockInfo> blocks, store_.read_index(tile));
    indexes_.push_front({tile, std::move(blocks)});
  }
  return &indexes_.front().blocks;
}

Result<const std::vector<Index3>*> NearestSearch::positions_of(std::size_t tile,
                                                               const BlockInfo& block) {
  const auto found = std::ranges::find(blocks_, block.first_row, &CachedBlock::first_row);
  if (found != blocks_.end()) {
    blocks_.splice(blocks_.begin(), blocks_, found);
  } else {
    std::vector<Index3> positions;
    PSS_TRY(exclusion_.read_kept(store_, store_.tiles()[tile], block, positions));
    blocks_.push_front({block.first_row, std::move(positions)});
    if (blocks_.size() > most_blocks_) blocks_.pop_back();
  }
  return &blocks_.front().positions;
}

Result<std::vector<Neighbour>> NearestSearch::nearest(const Index3& query, std::size_t count) {
  const Lattice& lattice = store_.header().lattice;
  while (indexes_.size() > kMostIndexes) indexes_.pop_back();
  std::priority_queue<Place, std::vector<Place>, std::greater<>> places;
  for (std::size_t t = 0; t < store_.tiles().size(); ++t)
    places.push({distance_sq(lattice, query, store_.tiles()[t].box), t, nullptr});
  NearestPositions nearest(count);
  while (!places.empty() && (!nearest.full() || places.top().distance_sq <= nearest.largest())) {
    const Place place = places.top();
    places.pop();
    if (place.block) {
      PSS_ASSIGN(const std::vector<Index3>* positions, positions_of(place.tile, *place.block));
      add(lattice, query, *positions, nearest);
    } else {
      PSS_ASSIGN(const std::vector<BlockInfo>* blocks, index_of(place.tile));
      for (const BlockInfo& block : *blocks)
        places.push({distance_sq(lattice, query, block.box), place.tile, &block});
    }
  }
  return nearest.take();
}

}  // namespace pss
