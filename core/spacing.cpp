#include "core/spacing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pss {
namespace {

constexpr std::size_t kRank = kSpacingRank;
constexpr std::size_t kMostLookedAt = 256;  ///< of the neighbours of a sampled position
constexpr double kTwinsApart = 0.1;         ///< spacings

double quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

Spacing summary_of(const std::vector<SampledPosition>& points) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const SampledPosition& point : points) distances.push_back(point.d16);
  std::ranges::sort(distances);
  Spacing spacing;
  spacing.d16 = quantile(distances, 0.5);
  spacing.d16_low = quantile(distances, 0.1);
  spacing.d16_high = quantile(distances, 0.9);
  spacing.spacing = spacing_of_d16(spacing.d16);
  spacing.sample = distances.size();
  return spacing;
}

/// The least squared distance between any two of a position and its neighbours.
double closest_sq(const Lattice& lattice, std::span<const Neighbour> nearest) {
  double least = nearest.front().first;
  for (std::size_t i = 0; i < nearest.size(); ++i)
    for (std::size_t j = i + 1; j < nearest.size(); ++j)
      least = std::min(least, distance_sq(lattice, nearest[i].second, nearest[j].second));
  return least;
}

/// The distance to the 16th of the places that the neighbours lie at; empty where these are fewer.
std::optional<double> distance_to_place(const Lattice& lattice, const Index3& position,
                                        std::span<const Neighbour> nearest, double apart) {
  std::vector<Index3> places{position};
  for (const auto& [neighbour_sq, neighbour] : nearest) {
    const auto is_twin = [&, &p = neighbour](const Index3& place) {
      return distance_sq(lattice, place, p) < apart * apart;
    };
    if (std::ranges::any_of(places, is_twin)) continue;
    places.push_back(neighbour);
    if (places.size() > kRank) return std::sqrt(neighbour_sq);
  }
  return std::nullopt;
}

/// Looks at ever more neighbours until they lie at 16 places.
Result<double> measure_places(const Lattice& lattice, const Index3& position, double apart,
                              const NearestOf& nearest) {
  for (std::size_t count = 2 * kRank;; count *= 2) {
    PSS_ASSIGN(const std::vector<Neighbour> found, nearest(position, count));
    if (const auto distance = distance_to_place(lattice, position, found, apart)) return *distance;
    if (found.size() < count || count >= kMostLookedAt) return std::sqrt(found.back().first);
  }
}

/// What the first measurement finds.
struct FirstMeasurement {
  std::vector<SampledPosition> points;
  std::vector<double> closest_sq;  ///< of each with its neighbours
};

Result<FirstMeasurement> measure_positions(const Lattice& lattice, std::span<const Index3> sample,
                                           const NearestOf& nearest) {
  FirstMeasurement first;
  for (const Index3& position : sample) {
    PSS_ASSIGN(const std::vector<Neighbour> found, nearest(position, kRank));
    if (found.size() < kRank) continue;
    first.points.push_back({position, std::sqrt(found.back().first)});
    first.closest_sq.push_back(closest_sq(lattice, found));
  }
  return first;
}

}  // namespace

double spacing_of_distance(double distance, int rank) {
  return distance * std::sqrt(std::numbers::pi / rank);
}

double spacing_of_d16(double d16) { return spacing_of_distance(d16, kSpacingRank); }

Result<SpacingSample> spacing_over(const Lattice& lattice, std::span<const Index3> sample,
                                   const NearestOf& nearest) {
  if (sample.size() <= kRank) return SpacingSample();
  PSS_ASSIGN(FirstMeasurement first, measure_positions(lattice, sample, nearest));
  if (first.points.empty()) return SpacingSample();
  const double usual = summary_of(first.points).d16;
  std::vector<double> farther(first.points.size(), 1);
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    auto& [position, d16] = first.points[i];
    const double apart = kTwinsApart * spacing_of_d16(std::min(d16, usual));
    if (first.closest_sq[i] >= apart * apart) continue;
    PSS_ASSIGN(const double anew, measure_places(lattice, position, apart, nearest));
    farther[i] = anew / d16;
    d16 = anew;
  }
  std::ranges::sort(farther);
  SpacingSample result{summary_of(first.points), std::move(first.points)};
  result.spacing->twins = quantile(farther, 0.5);
  return result;
}

}  // namespace pss
