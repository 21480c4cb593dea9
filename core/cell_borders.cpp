#include "core/cell_borders.h"

#include <bit>
#include <numeric>

#include "core/touched_cells.h"

namespace pss {

int common_shift(const Index3& a, const Index3& b) {
  const std::uint64_t differing =
      (biased(a[0]) ^ biased(b[0])) | (biased(a[1]) ^ biased(b[1])) | (biased(a[2]) ^ biased(b[2]));
  return 64 - std::countl_zero(differing);
}

std::vector<Borders> count_borders(std::span<const Index3> points) {
  std::vector<Borders> borders(block_count(points.size()));
  for_each_block(points.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    Borders counts{};
    for (std::size_t i = std::max<std::size_t>(begin, 1); i < end; ++i)
      ++counts[static_cast<std::size_t>(common_shift(points[i - 1], points[i]))];
    borders[block] = counts;
  });
  return borders;
}

std::size_t borders_above(const Borders& borders, int shift) {
  return std::accumulate(borders.begin() + shift + 1, borders.end(), std::size_t{0});
}

int affordable_shift(const std::vector<Borders>& borders, std::size_t points, int shift) {
  int affordable = kLatticeBits;
  for (; affordable > shift; --affordable) {
    std::size_t cells = 1;
    for (const Borders& block : borders) cells += borders_above(block, affordable - 1);
    if (cells > points / kPointsPerCell + 1) break;
  }
  return affordable;
}

}  // namespace pss
