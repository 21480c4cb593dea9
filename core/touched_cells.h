#pragma once
// Which power-of-two cells a ball touches, as key ranges in ascending order.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/neighbours.h"

namespace pss {

/// Cells that a ball may touch; with sides of at least its radius it never touches more.
inline constexpr std::size_t kMostCells = 27;
/// Bounds the rounding of a plain sum of squares against length_sq, and much else.
inline constexpr double kSlack = 1e-12;

/// A search costs more than the points of cells so many levels coarser than a ball would like.
inline constexpr int kCoarser = 3;

using BiasedIndex3 = std::array<std::uint64_t, 3>;

/// An axis of the lattice counted from its lower end, as keys count it.
inline std::uint64_t biased(std::int64_t index) {
  return static_cast<std::uint64_t>(index - kLatticeMin);
}

/// The lowest bits of a cell's number along each axis, in one word.
struct CellPlace {
  static constexpr int kBits = 10;
  static constexpr std::uint32_t kMask = (1u << kBits) - 1;

  static std::uint32_t of(const Index3& point, int shift) {
    std::uint32_t place = 0;
    for (std::size_t a = 3; a-- > 0;)
      place = place << kBits | (static_cast<std::uint32_t>(biased(point[a]) >> shift) & kMask);
    return place;
  }
  static std::uint32_t along(std::uint32_t place, std::size_t axis) {
    return place >> (kBits * static_cast<int>(axis)) & kMask;
  }
};

/// The part of a key that one axis contributes.
inline Key axis_key(std::size_t axis, std::uint64_t position) {
  Index3 index{kLatticeMin, kLatticeMin, kLatticeMin};
  index[axis] += static_cast<std::int64_t>(position);
  return encode_key(index);
}

/// The key after the last one of the cell of side 2^shift that begins at `first`.
inline Key after_cell(Key first, int shift) {
  constexpr std::uint64_t kWord = std::uint64_t{1} << 63;
  if (3 * shift >= 63) return {first.high + (std::uint64_t{1} << (3 * shift - 63)), first.low};
  first.low += std::uint64_t{1} << (3 * shift);
  if (first.low >= kWord) return {first.high + 1, first.low - kWord};
  return first;
}

/// The largest number of whole steps that a length may reach along an axis, and one more.
inline std::int64_t steps_within(double length, double scale) {
  constexpr double kMost = 0x1p43;
  return static_cast<std::int64_t>(std::min(length / scale, kMost)) + 1;
}

/// The lattice's part of a box around a ball.
struct BallBox {
  BiasedIndex3 low;
  BiasedIndex3 high;

  BallBox(const Lattice& lattice, const Query& query, double radius) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t steps =
          steps_within(radius + std::abs(query.remainder[a]), lattice.scale[a]);
      low[a] = biased(std::clamp(query.position[a] - steps, kLatticeMin, kLatticeMax));
      high[a] = biased(std::clamp(query.position[a] + steps, kLatticeMin, kLatticeMax));
    }
  }

  std::uint64_t cells_along(std::size_t axis, int shift) const {
    return (high[axis] >> shift) - (low[axis] >> shift) + 1;
  }

  /// The smallest cells of which the box touches no more than kMostCells.
  int shift() const {
    const std::uint64_t longest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    int shift = std::max(0, 59 - std::countl_zero(longest));  // 1/32 of it at least
    while (cells_along(0, shift) * cells_along(1, shift) * cells_along(2, shift) > kMostCells)
      ++shift;
    return shift;
  }
};

/// One axis of a box's cells: their parts of the key, and how far from the ball's centre they are.
struct CellSlabs {
  std::array<Key, kMostCells> key;
  std::array<double, kMostCells> distance_sq;
  std::size_t count;

  CellSlabs(const Lattice& lattice, const Query& query, const BallBox& box, int shift,
            std::size_t axis)
      : count(box.cells_along(axis, shift)) {
    const std::uint64_t centre = biased(query.position[axis]);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t first = ((box.low[axis] >> shift) + i) << shift;
      const std::uint64_t last = first + (std::uint64_t{1} << shift) - 1;
      const std::uint64_t gap = centre < first ? first - centre : centre > last ? centre - last : 0;
      const double least = lattice.scale[axis] * static_cast<double>(gap) -
                           std::abs(query.remainder[axis]) * (1 + kSlack);
      key[i] = axis_key(axis, first);
      distance_sq[i] = least > 0 ? least * least : 0;
    }
  }
};

/// The first keys of the cells that a ball may touch, in order.
struct TouchedCells {
  std::array<Key, kMostCells> first;
  std::size_t count = 0;
  int shift;

  /// Takes the grid's cells, of side 2^grid_shift, if the best ones are up to kCoarser levels
  /// finer: their borders need no search among points.
  TouchedCells(const Lattice& lattice, const Query& query, double radius, int grid_shift) {
    const BallBox box(lattice, query, radius);
    shift = box.shift();
    if (shift < grid_shift && shift >= grid_shift - kCoarser) shift = grid_shift;
    const CellSlabs x(lattice, query, box, shift, 0);
    const CellSlabs y(lattice, query, box, shift, 1);
    const CellSlabs z(lattice, query, box, shift, 2);
    const double limit = radius * radius * (1 + kSlack);
    for (std::size_t k = 0; k < z.count; ++k)
      for (std::size_t j = 0; j < y.count; ++j)
        for (std::size_t i = 0; i < x.count; ++i) {
          if (x.distance_sq[i] + y.distance_sq[j] + z.distance_sq[k] > limit) continue;
          first[count++] = {x.key[i].high | y.key[j].high | z.key[k].high,
                            x.key[i].low | y.key[j].low | z.key[k].low};
        }
    std::sort(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(count));
  }
};

}  // namespace pss
