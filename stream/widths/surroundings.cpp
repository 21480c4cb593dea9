#include "stream/widths/surroundings.h"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <map>

#include "core/morton.h"
#include "stream/passes/box_tree.h"
#include "stream/passes/exclusion.h"
#include "stream/widths/distance_filter.h"

namespace pss {
namespace {

constexpr std::size_t kMostSites = 16;                        ///< at once: a few vectors' lanes
constexpr std::size_t kMostIndexes = 32;                      ///< block indexes that are kept
constexpr std::uint64_t kBytesPerPoint = sizeof(Index3) + 8;  ///< with the grid over them

IndexBox box_at(const Index3& position) { return {position, position}; }

/// Blocks of a sorted store come in this order already.
void sort_by_key(std::vector<Index3>& points) {
  if (!std::ranges::is_sorted(points, {}, encode_key)) std::ranges::sort(points, {}, encode_key);
}

/// A block, and which of the sites look into it.
struct NearBlock {
  std::size_t tile = 0;
  BlockInfo block;
  std::vector<const Site*> sites;
};

/// Reads surroundings, a group of sites at a time.
class SiteReader {
 public:
  SiteReader(const Store& store, std::span<const Site> sites)
      : store_(store), sites_(sites), exclusion_(store.header().schema), tiles_(boxes_of(store)) {}

  /// Empty where there are more points than fit.
  Result<std::optional<Surroundings>> read(std::size_t first, std::size_t count) {
    PSS_ASSIGN(const NearBlocks near, blocks_near(first, count));
    Surroundings around{first, count, {}};
    for (const auto& [row, block] : near) {
      PSS_TRY(add(block, around.points));
      if (around.points.size() > kMostAround) return std::optional<Surroundings>();
    }
    sort_by_key(around.points);
    return std::optional(std::move(around));
  }

 private:
  /// By first row: every block once.
  using NearBlocks = std::map<std::uint64_t, NearBlock>;
  using Index = std::pair<std::size_t, std::vector<BlockInfo>>;

  static BoxTree boxes_of(const Store& store) {
    std::vector<IndexBox> boxes;
    for (const TileInfo& tile : store.tiles()) boxes.push_back(tile.box);
    return BoxTree(std::move(boxes));
  }

  Result<const std::vector<BlockInfo>*> index_of(std::size_t tile) {
    const auto found = std::ranges::find(indexes_, tile, &Index::first);
    if (found != indexes_.end()) {
      indexes_.splice(indexes_.begin(), indexes_, found);
    } else {
      PSS_ASSIGN(std::vector<BlockInfo> blocks, store_.read_index(tile));
      indexes_.emplace_front(tile, std::move(blocks));
      if (indexes_.size() > kMostIndexes) indexes_.pop_back();
    }
    return &indexes_.front().second;
  }

  Result<NearBlocks> blocks_near(std::size_t first, std::size_t count) {
    const Lattice& lattice = store_.header().lattice;
    NearBlocks near;
    for (const Site& site : sites_.subspan(first, count))
      for (const std::size_t tile : tiles_.within(lattice, box_at(site.position), site.reach)) {
        PSS_ASSIGN(const std::vector<BlockInfo>* blocks, index_of(tile));
        for (const BlockInfo& block : *blocks) {
          if (distance_sq(lattice, site.position, block.box) > site.reach * site.reach) continue;
          NearBlock& entry =
              near.try_emplace(block.first_row, NearBlock{tile, block, {}}).first->second;
          entry.sites.push_back(&site);
        }
      }
    return near;
  }

  Result<void> add(const NearBlock& near, std::vector<Index3>& points) {
    const TileInfo& tile = store_.tiles()[near.tile];
    PSS_TRY(exclusion_.read_kept(store_, tile, near.block, positions_));
    const Lattice& lattice = store_.header().lattice;
    for (const Index3& position : positions_) {
      const auto sees = [&](const Site* site) {
        const double reach_sq = site->reach * site->reach;
        return !surely_farther(lattice, position, site->position, reach_sq) &&
               distance_sq(lattice, position, site->position) <= reach_sq;
      };
      if (std::ranges::any_of(near.sites, sees)) points.push_back(position);
    }
    return {};
  }

  const Store& store_;
  std::span<const Site> sites_;
  Exclusion exclusion_;
  BoxTree tiles_;
  std::list<Index> indexes_;  ///< most recently used first
  std::vector<Index3> positions_;
};

}  // namespace

std::uint64_t surroundings_memory() { return (kMostAround + kBlockPoints) * kBytesPerPoint; }

Result<void> for_each_surroundings(const Store& store, std::span<const Site> sites,
                                   MemoryBudget& budget, Monitor& monitor,
                                   const std::function<void(const Surroundings&)>& use) {
  const auto memory = budget.reserve(surroundings_memory());
  if (!memory) return budget.refusal("measuring the noise", surroundings_memory(), ", or --h");
  SiteReader reader(store, sites);
  std::size_t count = 1;
  for (std::size_t first = 0; first < sites.size();) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    count = std::min({count, kMostSites, sites.size() - first});
    PSS_ASSIGN(const std::optional<Surroundings> around, reader.read(first, count));
    if (around) use(*around);
    if (around || count == 1) {
      first += count;
      count *= 2;
    } else {
      count /= 2;
    }
  }
  return {};
}

}  // namespace pss
