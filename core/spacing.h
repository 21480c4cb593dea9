#pragma once
// The rule that turns distances to neighbours into the mean spacing of points on a surface.

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/nearest_positions.h"
#include "core/result.h"

namespace pss {

/// The nearest-neighbour rank that spacings are measured at, among distinct positions.
inline constexpr int kSpacingRank = 16;
/// The spacing is measured on so many distinct positions (PositionSample).
inline constexpr std::size_t kSpacingSample = 4096;

/// The distance to the `rank`-th nearest to spacing: a disc of that radius holds `rank` points,
/// each with an area of spacing^2.
double spacing_of_distance(double distance, int rank);
/// The same at kSpacingRank.
double spacing_of_d16(double d16);

/// The distance to the 16th neighbour over the sample, twins counted once.
struct Spacing {
  double spacing = 0;   ///< spacing_of_d16() of the median: the mean of points on a surface
  double d16 = 0;       ///< the median
  double d16_low = 0;   ///< 10th percentile
  double d16_high = 0;  ///< 90th percentile
  std::size_t sample = 0;
  double twins = 1;  ///< median of d16 over the distance to the 16th position; 1: few twins or none

  /// Whether the density varies so much that each point should own its width.
  bool varying() const { return d16_high > 4 * d16_low; }
};

/// A sampled position and the distance to its 16th neighbour, twins counted once.
struct SampledPosition {
  Index3 position{};
  double d16 = 0;
};

/// The spacing and what it was measured on; empty where there are fewer than 17 distinct positions.
struct SpacingSample {
  std::optional<Spacing> spacing;
  std::vector<SampledPosition> points;  ///< in key order
};

/// The so many distinct positions that are nearest to one, its own excluded, in the order of
/// Neighbour; all, where there are fewer.
using NearestOf =
    std::function<Result<std::vector<Neighbour>>(const Index3& position, std::size_t count)>;

/// Measures the spacing twice, so that twins (first and last returns of one place) count once.
///
/// First the 16th nearest position of each sampled one gives its own spacing and the usual one. Two
/// positions nearer than a tenth of the smaller of these are twins. Then the nearest positions are
/// counted in the order of Neighbour, without the twins of the sampled position and of those that
/// are counted already: the 16th tells d16. Where 256 positions hold fewer, the last of them does.
/// Without twins both measurements are the same to the last bit.
///
/// Requires: `sample` is that of PositionSample, and `nearest` looks at the same positions.
/// Errors:   those of `nearest`.
/// Cost:     a search for 16 neighbours of each, and one for 32 to 256 of those near twins.
Result<SpacingSample> spacing_over(const Lattice& lattice, std::span<const Index3> sample,
                                   const NearestOf& nearest);

}  // namespace pss
