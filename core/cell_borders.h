#pragma once
// Where a new cell begins among points in key order, counted for every size of cells at once.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/parallel.h"

namespace pss {

/// Points a cell on average, at least: what keeps a grid's table small beside the points.
inline constexpr std::size_t kPointsPerCell = 8;
/// Points that one task looks at when a grid is made.
inline constexpr std::size_t kBlockPoints = std::size_t{1} << 15;

/// How many points are parted from the one before by the borders of cells: element s of those that
/// only a side of 2^s unites.
using Borders = std::array<std::uint32_t, kLatticeBits + 1>;

/// The side, as a power of two, of the smallest cell that holds both positions.
int common_shift(const Index3& a, const Index3& b);

inline std::size_t block_count(std::size_t points) {
  return (points + kBlockPoints - 1) / kBlockPoints;
}

/// Calls visit(block, begin, end) for ranges of points, in parallel.
template <class Visit>
void for_each_block(std::size_t points, Visit visit) {
  parallel_for(block_count(points), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b)
      visit(b, b * kBlockPoints, std::min(points, (b + 1) * kBlockPoints));
  });
}

/// The borders within each block and at its front.
std::vector<Borders> count_borders(std::span<const Index3> points);

/// How many of the borders remain where cells have the side 2^shift.
std::size_t borders_above(const Borders& borders, int shift);

/// The finest cells, at least of side 2^shift, that hold kPointsPerCell points on average.
int affordable_shift(const std::vector<Borders>& borders, std::size_t points, int shift);

}  // namespace pss
