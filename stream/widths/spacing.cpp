#include "stream/widths/spacing.h"

#include "core/position_sample.h"
#include "stream/passes/exclusion.h"
#include "stream/widths/nearest.h"

namespace pss {
namespace {

/// In key order.
Result<std::vector<Index3>> choose_sample(const Store& store, Monitor& monitor) {
  const Exclusion exclusion(store.header().schema);
  PositionSample sample(kSpacingSample);
  std::vector<Index3> positions;
  for (std::size_t t = 0; t < store.tiles().size(); ++t) {
    PSS_ASSIGN(const std::vector<BlockInfo> index, store.read_index(t));
    for (const BlockInfo& block : index) {
      if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
      PSS_TRY(exclusion.read_kept(store, store.tiles()[t], block, positions));
      for (const Index3& position : positions) sample.add(position);
      monitor.advance(block.count);
    }
    monitor.advance(0, 1);
  }
  return sample.positions();
}

}  // namespace

Result<SpacingSample> sample_spacing(const Store& store, MemoryBudget& budget, Monitor& monitor) {
  monitor.begin("spacing", store.points(), store.tiles().size());
  PSS_ASSIGN(const std::vector<Index3> sample, choose_sample(store, monitor));
  NearestSearch search(store, budget);
  const NearestOf nearest = [&](const Index3& position,
                                std::size_t count) -> Result<std::vector<Neighbour>> {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    return search.nearest(position, count);
  };
  return spacing_over(store.header().lattice, sample, nearest);
}

Result<std::optional<Spacing>> measure_spacing(const Store& store, MemoryBudget& budget,
                                               Monitor& monitor) {
  PSS_ASSIGN(const SpacingSample sample, sample_spacing(store, budget, monitor));
  return sample.spacing;
}

}  // namespace pss
