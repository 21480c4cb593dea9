#include "stream/passes/box_tree.h"

#include <algorithm>
#include <utility>

namespace pss {

BoxTree::BoxTree(std::vector<IndexBox> boxes) {
  levels_.push_back(std::move(boxes));
  while (levels_.back().size() > 1) {
    const std::vector<IndexBox>& below = levels_.back();
    std::vector<IndexBox> level((below.size() + kFanOut - 1) / kFanOut);
    for (std::size_t i = 0; i < below.size(); ++i) level[i / kFanOut].add(below[i]);
    levels_.push_back(std::move(level));
  }
}

std::vector<std::size_t> BoxTree::within(const Lattice& lattice, const IndexBox& box,
                                         double reach) const {
  std::vector<std::size_t> found;
  if (!levels_.front().empty()) collect(levels_.size() - 1, 0, lattice, box, reach * reach, found);
  return found;
}

void BoxTree::collect(std::size_t level, std::size_t node, const Lattice& lattice,
                      const IndexBox& box, double reach_sq, std::vector<std::size_t>& found) const {
  const IndexBox& bounds = levels_[level][node];
  if (bounds.empty() || distance_sq(lattice, bounds, box) > reach_sq) return;
  if (level == 0) {
    found.push_back(node);
    return;
  }
  const std::size_t end = std::min((node + 1) * kFanOut, levels_[level - 1].size());
  for (std::size_t child = node * kFanOut; child < end; ++child)
    collect(level - 1, child, lattice, box, reach_sq, found);
}

}  // namespace pss
