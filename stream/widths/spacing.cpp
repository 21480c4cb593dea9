#include "stream/widths/spacing.h"

#include <memory>

#include "core/position_sample.h"
#include "core/spares.h"
#include "stream/passes/each_block.h"
#include "stream/passes/source.h"
#include "stream/widths/nearest.h"

namespace pss {
namespace {

/// Shows the positions of some tiles' blocks to samples of their own, by all threads.
class Sampler {
 public:
  explicit Sampler(const Source& source) : source_(source) {}

  Result<void> add(std::size_t tile) {
    PSS_ASSIGN(const std::vector<BlockInfo> index, source_.read_index(tile));
    return for_each_block(index.size(), [&](std::size_t b) { return add(tile, index[b]); });
  }

  /// In key order: those of smallest hash, whoever saw them.
  std::vector<Index3> positions() {
    PositionSample all(kSpacingSample);
    while (const std::unique_ptr<PositionSample> sample = samples_.take())
      for (const Index3& position : sample->positions()) all.add(position);
    return all.positions();
  }

 private:
  Result<void> add(std::size_t tile, const BlockInfo& block) {
    std::vector<Index3> positions;
    PSS_TRY(source_.read_neighbours(tile, block, positions));
    std::unique_ptr<PositionSample> sample = samples_.take();
    if (!sample) sample = std::make_unique<PositionSample>(kSpacingSample);
    for (const Index3& position : positions) sample->add(position);
    samples_.give(std::move(sample));
    return {};
  }

  const Source& source_;
  Spares<PositionSample> samples_;
};

/// In key order.
Result<std::vector<Index3>> choose_sample(const Source& source, Monitor& monitor) {
  Sampler sampler(source);
  for (std::size_t t = 0; t < source.tiles().size(); ++t) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    PSS_TRY(sampler.add(t));
    monitor.advance(source.tiles()[t].count, 1);
  }
  return sampler.positions();
}

}  // namespace

Result<SpacingSample> sample_spacing(const Source& source, MemoryBudget& budget, Monitor& monitor) {
  monitor.begin("spacing", source.points(), source.tiles().size());
  PSS_ASSIGN(const std::vector<Index3> sample, choose_sample(source, monitor));
  NearestSearch search(source, budget);
  const NearestOf nearest = [&](const Index3& position,
                                std::size_t count) -> Result<std::vector<Neighbour>> {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    return search.nearest(position, count);
  };
  return spacing_over(source.lattice(), sample, nearest);
}

Result<std::optional<Spacing>> measure_spacing(const Source& source, MemoryBudget& budget,
                                               Monitor& monitor) {
  PSS_ASSIGN(const SpacingSample sample, sample_spacing(source, budget, monitor));
  return sample.spacing;
}

}  // namespace pss
