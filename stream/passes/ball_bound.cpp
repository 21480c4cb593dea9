#include "stream/passes/ball_bound.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "core/parallel.h"

namespace pss {
namespace {

/// Points whose balls are counted together first.
constexpr std::size_t kGroup = 256;

/// Counts for one thread; what counts as many is found among all of them.
class Counter {
 public:
  Counter(const CellGrid& grid, std::span<const Index3> own,
          const std::function<double(std::size_t)>& reach, std::atomic<std::uint64_t>& most)
      : grid_(grid), own_(own), reach_(reach), most_(most) {}

  /// Only points that may have a fuller ball than all before are looked at more closely.
  void count(std::size_t begin, std::size_t end) {
    IndexBox box;
    double reach = -1;
    for (std::size_t i = begin; i < end; ++i) {
      box.add(own_[i]);
      reach = std::max(reach, reach_(i));
    }
    if (reach < 0) return;
    const std::uint64_t points = points_within(box, reach);
    if (points <= most_) return;
    if (box.min == box.max) return raise_to(points);
    const std::size_t middle = begin + (end - begin) / 2;
    count(begin, middle);
    count(middle, end);
  }

 private:
  std::uint64_t points_within(const IndexBox& box, double reach) {
    grid_.gather_ranges(box, reach, ranges_);
    std::uint64_t points = 0;
    for (const PointRange& range : ranges_) points += range.end - range.begin;
    return points;
  }

  void raise_to(std::uint64_t points) {
    std::uint64_t most = most_;
    while (most < points && !most_.compare_exchange_weak(most, points)) {
    }
  }

  const CellGrid& grid_;
  std::span<const Index3> own_;
  const std::function<double(std::size_t)>& reach_;
  std::atomic<std::uint64_t>& most_;
  std::vector<PointRange> ranges_;
};

}  // namespace

std::uint64_t ball_bound(const CellGrid& grid, std::span<const Index3> own,
                         const std::function<double(std::size_t)>& reach, std::uint64_t enough) {
  std::atomic<std::uint64_t> most = enough;
  parallel_for((own.size() + kGroup - 1) / kGroup, 8, [&](std::size_t begin, std::size_t end) {
    Counter counter(grid, own, reach, most);
    for (std::size_t g = begin; g < end; ++g)
      counter.count(g * kGroup, std::min((g + 1) * kGroup, own.size()));
  });
  return most;
}

}  // namespace pss
