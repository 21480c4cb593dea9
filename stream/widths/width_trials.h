#pragma once
// Projects a sample of a source at several widths, and reads off what tells noise from shape.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/method.h"
#include "core/monitor.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/source.h"
#include "stream/widths/spacing.h"

namespace pss {

/// The widths that are tried, in spacings.
inline constexpr std::array<double, 5> kTriedWidths{2, 3, 4, 5, 6};
/// At most so many sampled positions are projected.
inline constexpr std::size_t kNoiseSample = 512;

/// One sampled position at one width. Lengths in spacings: those of the source, or where the
/// spacing varies the position's own.
struct Reading {
  bool usable = false;     ///< determined, and not at a boundary
  bool disturbed = false;  ///< by another sheet: the numbers tell nothing
  double residual_sq = 0;
  double area = 0;                  ///< of the surface, a neighbour
  double bend = 0;                  ///< h times the larger principal curvature
  std::optional<double> change_sq;  ///< of the height up to the next width
};

/// The same positions at every width.
struct Readings {
  std::array<std::vector<Reading>, kTriedWidths.size()> at;
  std::vector<double> sheets;  ///< distances of other sheets, where there are any

  std::size_t sample() const { return at.front().size(); }
};

/// Projects every n-th position of the sample by `fast` with the weight and the degree of `method`:
/// levin finds the same surface, and the others' are about as smooth as their degree says.
///
/// A pure function of the source's points. Positions in crowded places are left out.
///
/// Requires: `sample` has a spacing.
/// Errors:   kMemoryLimit, kInterrupted, and what reading the stores gives.
/// Cost:     the blocks around each of kNoiseSample positions, five projections of each.
Result<Readings> try_widths(const Source& source, const SpacingSample& sample, const Method& method,
                            MemoryBudget& budget, Monitor& monitor);

/// What must be left of the limit for that.
std::uint64_t width_memory();

}  // namespace pss
