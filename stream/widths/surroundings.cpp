#include "stream/widths/surroundings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/morton.h"
#include "stream/passes/box_tree.h"
#include "stream/passes/index_cache.h"
#include "stream/widths/distance_filter.h"

namespace pss {
namespace {

constexpr std::size_t kMostSites = 16;                        ///< at once: a few vectors' lanes
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
  SiteReader(const Source& source, std::span<const Site> sites)
      : source_(source), sites_(sites), tiles_(BoxTree::of(source.tiles())), indexes_(source) {}

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

  Result<NearBlocks> blocks_near(std::size_t first, std::size_t count) {
    const Lattice& lattice = source_.lattice();
    NearBlocks near;
    for (const Site& site : sites_.subspan(first, count))
      for (const std::size_t tile : tiles_.within(lattice, box_at(site.position), site.reach)) {
        PSS_ASSIGN(const std::vector<BlockInfo>* blocks, indexes_.blocks_of(tile));
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
    PSS_TRY(source_.read_neighbours(near.tile, near.block, positions_));
    const Lattice& lattice = source_.lattice();
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

  const Source& source_;
  std::span<const Site> sites_;
  BoxTree tiles_;
  IndexCache indexes_;
  std::vector<Index3> positions_;
};

}  // namespace

std::uint64_t surroundings_memory() { return (kMostAround + kBlockPoints) * kBytesPerPoint; }

Result<void> for_each_surroundings(const Source& source, std::span<const Site> sites,
                                   MemoryBudget& budget, Monitor& monitor,
                                   const std::function<void(const Surroundings&)>& use) {
  const auto memory = budget.reserve(surroundings_memory());
  if (!memory) return budget.refusal("measuring the noise", surroundings_memory(), ", or --h");
  SiteReader reader(source, sites);
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
