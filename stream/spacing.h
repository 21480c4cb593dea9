#pragma once
// How far apart the points of a store are, measured on a sample that depends on nothing but them.

#include <cstddef>
#include <optional>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "core/spacing.h"
#include "stream/memory.h"
#include "stream/store.h"

namespace pss {

/// The distance to the 16th nearest distinct position, over the sample.
struct Spacing {
  double spacing = 0;   ///< spacing_of_d16() of the median: the mean of points on a surface
  double d16 = 0;       ///< the median
  double d16_low = 0;   ///< 10th percentile
  double d16_high = 0;  ///< 90th percentile
  std::size_t sample = 0;

  /// Whether the density varies so much that each point should own its width.
  bool varying() const { return d16_high > 4 * d16_low; }
};

/// The distinct positions of smallest hash that are measured.
inline constexpr std::size_t kSpacingSample = 4096;

/// A sampled position and the distance to its 16th nearest.
struct SampledPosition {
  Index3 position{};
  double d16 = 0;
};

/// The spacing and what it was measured on; empty where there are fewer than 17 distinct positions.
struct SpacingSample {
  std::optional<Spacing> spacing;
  std::vector<SampledPosition> points;  ///< in key order
};

/// Measures the spacing of all points but the excluded (Exclusion).
///
/// Reads all positions once to choose the sample, then the blocks around each sampled position,
/// nearest first, until the 16th nearest is certain.
Result<SpacingSample> sample_spacing(const Store& store, MemoryBudget& budget, Monitor& monitor);

/// The same, where the sample is not of interest.
Result<std::optional<Spacing>> measure_spacing(const Store& store, MemoryBudget& budget,
                                               Monitor& monitor);

}  // namespace pss
