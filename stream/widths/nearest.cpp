#include "stream/widths/nearest.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "stream/widths/distance_filter.h"

namespace pss {
namespace {

constexpr std::size_t kBlockBytes = kBlockPoints * sizeof(Index3);
constexpr std::uint64_t kCacheBytes = 16u << 20;
constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// A block that may hold near positions. Copied: indexes come and go.
struct NearBlock {
  double distance_sq;
  std::size_t tile;
  BlockInfo block;
  bool operator>(const NearBlock& other) const { return distance_sq > other.distance_sq; }
};

void add(const Lattice& lattice, const Index3& query, const std::vector<Index3>& positions,
         NearestPositions& nearest) {
  for (const Index3& position : positions) {
    if (nearest.full() && surely_farther(lattice, query, position, nearest.largest())) continue;
    if (position != query) nearest.add(distance_sq(lattice, query, position), position);
  }
}

}  // namespace

NearestSearch::NearestSearch(const Source& source, MemoryBudget& budget)
    : source_(source), tiles_(BoxTree::of(source.tiles())), indexes_(source) {
  const std::uint64_t bytes = std::min<std::uint64_t>(kCacheBytes, budget.available() / 2);
  if (auto memory = budget.reserve(bytes)) memory_ = std::move(*memory);
  most_blocks_ = std::max<std::size_t>(4, memory_.bytes() / kBlockBytes);
}

Result<const std::vector<Index3>*> NearestSearch::positions_of(std::size_t tile,
                                                               const BlockInfo& block) {
  const auto found = std::ranges::find(blocks_, block.first_row, &CachedBlock::first_row);
  if (found != blocks_.end()) {
    blocks_.splice(blocks_.begin(), blocks_, found);
  } else {
    std::vector<Index3> positions;
    PSS_TRY(source_.read_neighbours(tile, block, positions));
    blocks_.push_front({block.first_row, std::move(positions)});
    if (blocks_.size() > most_blocks_) blocks_.pop_back();
  }
  return &blocks_.front().positions;
}

Result<std::vector<Neighbour>> NearestSearch::nearest(const Index3& query, std::size_t count) {
  const Lattice& lattice = source_.lattice();
  BoxTree::NearestFirst tiles(tiles_, lattice, query);
  std::priority_queue<NearBlock, std::vector<NearBlock>, std::greater<>> near;
  NearestPositions nearest(count);
  for (;;) {
    const double tile = tiles.distance_sq();
    const double block = near.empty() ? kNowhere : near.top().distance_sq;
    const double next = std::min(tile, block);
    if (next == kNowhere || (nearest.full() && next > nearest.largest())) return nearest.take();
    if (block <= tile) {
      PSS_ASSIGN(const std::vector<Index3>* positions,
                 positions_of(near.top().tile, near.top().block));
      near.pop();
      add(lattice, query, *positions, nearest);
    } else {
      const std::size_t number = tiles.take();
      PSS_ASSIGN(const std::vector<BlockInfo>* blocks, indexes_.blocks_of(number));
      for (const BlockInfo& b : *blocks) near.push({distance_sq(lattice, query, b.box), number, b});
    }
  }
}

}  // namespace pss
