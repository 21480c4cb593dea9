#include "stream/spacing.h"

#include <algorithm>
#include <queue>
#include <set>

#include "core/morton.h"
#include "stream/exclusion.h"
#include "stream/nearest.h"

namespace pss {
namespace {

/// A fixed mixing of a position's key; nothing but the position decides it.
std::uint64_t hash_position(const Index3& position) {
  const Key key = encode_key(position);
  std::uint64_t h = key.high * 0x9e3779b97f4a7c15 ^ key.low;
  for (const std::uint64_t factor : {0xbf58476d1ce4e5b9, 0x94d049bb133111eb}) {
    h = (h ^ h >> 31) * factor;
  }
  return h ^ h >> 29;
}

/// Keeps the distinct positions of smallest hash.
class Sample {
 public:
  void add(const Index3& position) {
    const Entry entry{hash_position(position), position};
    if (chosen_.size() == kSpacingSample && !(entry < *chosen_.rbegin())) return;
    chosen_.insert(entry);
    if (chosen_.size() > kSpacingSample) chosen_.erase(std::prev(chosen_.end()));
  }

  /// In key order, so that consecutive queries share blocks.
  std::vector<Index3> positions() const {
    std::vector<Index3> positions;
    for (const Entry& entry : chosen_) positions.push_back(entry.second);
    std::ranges::sort(positions, {}, encode_key);
    return positions;
  }

 private:
  using Entry = std::pair<std::uint64_t, Index3>;
  std::set<Entry> chosen_;
};

Result<Sample> choose_sample(const Store& store, Monitor& monitor) {
  const Exclusion exclusion(store.header().schema);
  Sample sample;
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
  return sample;
}

double quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

Spacing spacing_over(const std::vector<SampledPosition>& points) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const SampledPosition& point : points) distances.push_back(point.d16);
  std::sort(distances.begin(), distances.end());
  Spacing spacing;
  spacing.d16 = quantile(distances, 0.5);
  spacing.d16_low = quantile(distances, 0.1);
  spacing.d16_high = quantile(distances, 0.9);
  spacing.spacing = spacing_of_d16(spacing.d16);
  spacing.sample = distances.size();
  return spacing;
}

}  // namespace

Result<SpacingSample> sample_spacing(const Store& store, MemoryBudget& budget, Monitor& monitor) {
  monitor.begin("spacing", store.points(), store.tiles().size());
  PSS_ASSIGN(const Sample sample, choose_sample(store, monitor));
  const std::vector<Index3> queries = sample.positions();
  SpacingSample result;
  if (queries.size() <= static_cast<std::size_t>(kSpacingRank)) return result;

  NearestSearch search(store, budget);
  for (const Index3& query : queries) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    PSS_ASSIGN(const std::optional<double> distance, search.kth_distance(query, kSpacingRank));
    if (distance) result.points.push_back({query, *distance});
  }
  result.spacing = spacing_over(result.points);
  return result;
}

Result<std::optional<Spacing>> measure_spacing(const Store& store, MemoryBudget& budget,
                                               Monitor& monitor) {
  PSS_ASSIGN(const SpacingSample sample, sample_spacing(store, budget, monitor));
  return sample.spacing;
}

}  // namespace pss
