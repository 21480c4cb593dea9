#include "core/world_sample.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/parallel.h"
#include "core/spacing.h"

namespace pss {
namespace {

/// So many positions of the sample are asked for their neighbours in it.
constexpr std::size_t kSampleQueries = 512;

/// A fixed mixing of the coordinates' bits; 0 and -0 are one place.
std::uint64_t hash_position(const World3& position) {
  std::uint64_t h = 0x9e3779b97f4a7c15;
  for (const double coordinate : position) {
    h = (h ^ std::bit_cast<std::uint64_t>(coordinate + 0.0)) * 0xbf58476d1ce4e5b9;
    h = (h ^ h >> 31) * 0x94d049bb133111eb;
    h ^= h >> 29;
  }
  return h;
}

double squared_distance(const World3& a, const World3& b) {
  return length_sq(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The distance from a position of the sample to its `rank`-th nearest other.
double distance_within(std::span<const World3> sample, const World3& from, int rank) {
  std::vector<double> squares;
  squares.reserve(sample.size());
  for (const World3& other : sample) squares.push_back(squared_distance(from, other));
  const auto nth = squares.begin() + rank;  // the nearest is the position itself
  std::ranges::nth_element(squares, nth);
  return std::sqrt(*nth);
}

}  // namespace

void WorldSample::add(const World3& position) {
  const World3 place{position[0] + 0.0, position[1] + 0.0, position[2] + 0.0};
  const Entry entry{hash_position(place), place};
  const bool full = chosen_.size() == kMost;
  if (full && *chosen_.rbegin() < entry) {
    whole_ = false;
    return;
  }
  chosen_.insert(entry);
  if (chosen_.size() <= kMost) return;
  chosen_.erase(std::prev(chosen_.end()));
  whole_ = false;
}

double WorldSample::distinct() const {
  const auto count = static_cast<double>(chosen_.size());
  if (whole_) return count;
  // The hashes are even in [0, 2^64): the share below the largest kept one holds all kept ones.
  return (count - 1) * 0x1p64 / static_cast<double>(chosen_.rbegin()->first);
}

int WorldSample::rank() const {
  const std::size_t others = chosen_.empty() ? 0 : chosen_.size() - 1;
  return static_cast<int>(std::clamp<std::size_t>((others + 1) / 2, 1, kSpacingRank));
}

SampledSpacing WorldSample::spacing() const {
  if (chosen_.size() < 2) return {};
  const std::vector<World3> sample = first(kMost);
  std::vector<double> distances;
  for (const World3& query : first(kSampleQueries))
    distances.push_back(distance_within(sample, query, rank()));
  const double within = spacing_of_distance(median(std::move(distances)), rank());
  const double kept = static_cast<double>(chosen_.size()) / distinct();
  return {within * std::sqrt(kept), within * kept};
}

World3 WorldSample::middle() const {
  World3 middle{};
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> coordinates;
    for (const Entry& entry : chosen_) coordinates.push_back(entry.second[a]);
    middle[a] = median(std::move(coordinates));
  }
  return middle;
}

std::vector<World3> WorldSample::first(std::size_t most) const {
  std::vector<World3> positions;
  for (const Entry& entry : chosen_) {
    if (positions.size() == most) break;
    positions.push_back(entry.second);
  }
  return positions;
}

SpacingMeter::SpacingMeter(const WorldSample& sample)
    : rank_(static_cast<std::size_t>(sample.rank())) {
  for (const World3& position : sample.first(kQueries)) queries_.push_back({position, {}});
}

void SpacingMeter::add(std::span<const World3> positions) {
  parallel_for(queries_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) add(queries_[q], positions);
  });
}

void SpacingMeter::add(Query& query, std::span<const World3> positions) const {
  std::vector<Near>& nearest = query.nearest;
  double farthest = std::numeric_limits<double>::infinity();
  if (nearest.size() == rank_) farthest = nearest.back().first;
  for (const World3& position : positions) {
    const double square = squared_distance(query.position, position);
    if (square == 0 || !(square < farthest)) continue;
    const Near found{square, position};
    const auto at = std::ranges::lower_bound(nearest, found);
    if (at != nearest.end() && *at == found) continue;
    nearest.insert(at, found);
    if (nearest.size() > rank_) nearest.pop_back();
    if (nearest.size() == rank_) farthest = nearest.back().first;
  }
}

Result<double> spacing_beside(double step, const WorldSample& sample,
                              const std::function<Result<void>(SpacingMeter&)>& reread) {
  const SampledSpacing sampled = sample.spacing();
  const bool whole = sample.distinct() <= WorldSample::kMost;
  if (whole || !too_coarse(step, sampled.least)) return sampled.likely;
  SpacingMeter meter(sample);
  PSS_TRY(reread(meter));
  return meter.spacing();
}

double SpacingMeter::spacing() const {
  std::vector<double> distances;
  for (const Query& query : queries_)
    distances.push_back(query.nearest.size() < rank_ ? std::numeric_limits<double>::infinity()
                                                     : std::sqrt(query.nearest.back().first));
  return spacing_of_distance(median(std::move(distances)), static_cast<int>(rank_));
}

}  // namespace pss
