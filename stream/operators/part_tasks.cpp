#include "stream/operators/part_tasks.h"

#include <algorithm>

#include "stream/passes/operator.h"

namespace pss {

std::vector<Slice> slices_of(const Part& part) {
  std::vector<Slice> slices;
  std::size_t start = 0;
  for (std::size_t b = 0; b < part.block_counts.size(); ++b) {
    const std::size_t end = start + part.block_counts[b];
    while (start < end) {
      const std::size_t next = std::min(start + Operator::kTaskPoints, end);
      slices.push_back({b, start, next - start});
      start = next;
    }
  }
  return slices;
}

std::vector<PointRange> tasks_of(const Part& part, const std::vector<Slice>& slices) {
  std::vector<PointRange> tasks;
  for (std::size_t c = 0; c < slices.size(); ++c) {
    const std::size_t first = slices[c].first;
    if (c == 0 || part.own[first] != part.own[first - 1]) tasks.push_back({c, c});
    tasks.back().end = c + 1;
  }
  return tasks;
}

}  // namespace pss
