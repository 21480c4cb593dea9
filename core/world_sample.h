#pragma once
// How far apart the points of a scan are, told while its positions are read once, in any order.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/lattice.h"
#include "core/result.h"

namespace pss {

/// A step of coordinates may be this share of the points' spacing and no more: rounding then moves
/// a point by less than a hundredth of the way to its neighbours.
inline constexpr double kMostStepPerSpacing = 0.01;

/// The mean spacing of points on a surface, from a sample of them.
struct SampledSpacing {
  /// As thinning a surface spreads its points: by the root of the share that was left out.
  double likely = 0;
  /// As thinning a line does: by the share itself. Points on surfaces and in volumes are not
  /// nearer to each other than this.
  double least = 0;
};

/// The distinct positions of smallest hash: which ones depends on the positions alone, neither on
/// their order nor on how often each occurs.
///
/// Cost: a hash a position; at most kMost are kept.
class WorldSample {
 public:
  static constexpr std::size_t kMost = 4096;

  /// Requires: finite.
  void add(const World3& position);

  /// How many distinct positions were added: exact up to kMost, above it estimated by the largest
  /// kept hash, with a standard error of 1.6 %.
  ///
  /// Source: Bar-Yossef et al., "Counting Distinct Elements in a Data Stream", 2002.
  double distinct() const;
  /// The rank of the neighbour whose distance tells the spacing: 16, of few positions fewer, so
  /// that half of them can lie far from the others.
  int rank() const;
  /// Zeros for fewer than two distinct positions. Exact where all of them are in the sample.
  SampledSpacing spacing() const;
  /// The median of the sample, an axis each: far points do not move it.
  World3 middle() const;
  /// The first `most` positions by hash.
  std::vector<World3> first(std::size_t most) const;

 private:
  using Entry = std::pair<std::uint64_t, World3>;
  std::set<Entry> chosen_;
  bool whole_ = true;  ///< no distinct position was left out
};

/// Measures the spacing around a few positions exactly, in a pass over all others.
class SpacingMeter {
 public:
  /// Enough that the median over them lies between the 38th and the 62nd percentile.
  static constexpr std::size_t kQueries = 64;

  explicit SpacingMeter(const WorldSample& sample);

  /// Adds positions, each any number of times. Cost: a distance to each query, by all threads.
  void add(std::span<const World3> positions);
  /// The median over the queries; 0 where there are none.
  double spacing() const;

 private:
  /// A squared distance, and the position at it: copies of a position count once.
  using Near = std::pair<double, World3>;
  struct Query {
    World3 position;
    std::vector<Near> nearest;  ///< ascending
  };
  void add(Query& query, std::span<const World3> positions) const;
  std::vector<Query> queries_;
  std::size_t rank_;
};

/// The spacing of the sampled points, as exactly as it takes to compare it with `step`; 0 where
/// there are fewer than two distinct positions.
///
/// Where the sample alone leaves open whether the step is fine enough, `reread` passes all
/// positions to a meter.
Result<double> spacing_beside(double step, const WorldSample& sample,
                              const std::function<Result<void>(SpacingMeter&)>& reread);
/// Whether a step is too coarse for points of this spacing; one that is not known permits any.
inline bool too_coarse(double step, double spacing) {
  return spacing > 0 && step > kMostStepPerSpacing * spacing;
}

}  // namespace pss
