#include "stream/ball_bound.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/morton.h"
#include "core/parallel.h"

namespace pss {
namespace {

constexpr std::size_t kCellsAtOnce = 1024;  ///< what one task looks at

struct CountedCell {
  Key key;  ///< of the cell's own coordinates
  std::uint32_t count;
};

Index3 cell_at(const Index3& point, int shift) {
  return {point[0] >> shift, point[1] >> shift, point[2] >> shift};
}

/// The smallest cells whose side is at least `radius` on every axis.
int shift_for(const Lattice& lattice, double radius) {
  const double steps = radius / std::min({lattice.scale[0], lattice.scale[1], lattice.scale[2]});
  int shift = 0;
  while (shift < kLatticeBits && std::ldexp(1.0, shift) < steps) ++shift;
  return shift;
}

/// Calls visit(cell, count) for every cell with points in it, in key order.
template <class Visit>
void for_each_cell(std::span<const Index3> points, int shift, Visit visit) {
  for (std::size_t begin = 0; begin < points.size();) {
    const Index3 cell = cell_at(points[begin], shift);
    std::size_t end = begin + 1;
    while (end < points.size() && cell_at(points[end], shift) == cell) ++end;
    visit(cell, static_cast<std::uint32_t>(end - begin));
    begin = end;
  }
}

std::uint32_t count_in(std::span<const CountedCell> cells, const Index3& cell) {
  if (!on_lattice(cell)) return 0;
  const Key key = encode_key(cell);
  const auto found = std::ranges::lower_bound(cells, key, {}, &CountedCell::key);
  return found != cells.end() && found->key == key ? found->count : 0;
}

/// The points of a cell and of the 26 around it.
std::uint64_t count_around(std::span<const CountedCell> cells, const Index3& cell) {
  std::uint64_t count = 0;
  for (std::int64_t x = -1; x <= 1; ++x)
    for (std::int64_t y = -1; y <= 1; ++y)
      for (std::int64_t z = -1; z <= 1; ++z)
        count += count_in(cells, {cell[0] + x, cell[1] + y, cell[2] + z});
  return count;
}

}  // namespace

std::uint64_t ball_bound_bytes(std::uint64_t points) {
  return points * sizeof(CountedCell) + (points / kCellsAtOnce + 1) * sizeof(std::uint64_t);
}

std::uint64_t ball_bound(const Lattice& lattice, std::span<const Index3> points, double radius,
                         std::uint64_t enough) {
  if (points.size() <= enough) return points.size();
  const int shift = shift_for(lattice, radius);
  std::uint64_t fullest = 0;
  std::size_t cell_count = 0;
  for_each_cell(points, shift, [&](const Index3&, std::uint32_t count) {
    fullest = std::max<std::uint64_t>(fullest, count);
    ++cell_count;
  });
  if (27 * fullest <= enough) return 27 * fullest;
  std::vector<CountedCell> cells;
  cells.reserve(cell_count);
  for_each_cell(points, shift, [&](const Index3& cell, std::uint32_t count) {
    cells.push_back({encode_key(cell), count});
  });
  std::vector<std::uint64_t> most((cells.size() + kCellsAtOnce - 1) / kCellsAtOnce, 0);
  parallel_for(most.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin * kCellsAtOnce; c < std::min(end * kCellsAtOnce, cells.size());
         ++c) {
      std::uint64_t& largest = most[c / kCellsAtOnce];
      largest = std::max(largest, count_around(cells, decode_key(cells[c].key)));
    }
  });
  return *std::ranges::max_element(most);
}

}  // namespace pss
