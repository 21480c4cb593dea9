#include "stream/ball_bound.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace pss {
namespace {

/// Points whose balls are counted together first.
constexpr std::size_t kGroup = 256;

class Counter {
 public:
  Counter(const CellGrid& grid, std::span<const Index3> own,
          const std::function<double(std::size_t)>& reach, std::uint64_t enough)
      : grid_(grid), own_(own), reach_(reach), enough_(enough) {}

  std::uint64_t fullest(std::size_t begin, std::size_t end) {
    IndexBox box;
    double reach = -1;
    for (std::size_t i = begin; i < end; ++i) {
      box.add(own_[i]);
      reach = std::max(reach, reach_(i));
    }
    if (reach < 0) return 0;
    grid_.gather_ranges(box, reach, ranges_);
    std::uint64_t points = 0;
    for (const PointRange& range : ranges_) points += range.end - range.begin;
    if (points <= enough_ || box.min == box.max) return points;
    const std::size_t middle = begin + (end - begin) / 2;
    return std::max(fullest(begin, middle), fullest(middle, end));
  }

 private:
  const CellGrid& grid_;
  std::span<const Index3> own_;
  const std::function<double(std::size_t)>& reach_;
  std::uint64_t enough_;
  std::vector<PointRange> ranges_;
};

}  // namespace

std::uint64_t ball_bound_bytes(std::uint64_t points) {
  return (points / kGroup + 1) * sizeof(std::uint64_t);
}

std::uint64_t ball_bound(const CellGrid& grid, std::span<const Index3> own,
                         const std::function<double(std::size_t)>& reach, std::uint64_t enough) {
  if (own.empty()) return 0;
  std::vector<std::uint64_t> most((own.size() + kGroup - 1) / kGroup, 0);
  parallel_for(most.size(), 8, [&](std::size_t begin, std::size_t end) {
    Counter counter(grid, own, reach, enough);
    for (std::size_t g = begin; g < end; ++g)
      most[g] = counter.fullest(g * kGroup, std::min((g + 1) * kGroup, own.size()));
  });
  return *std::ranges::max_element(most);
}

}  // namespace pss
