#include "stream/passes/box_tree.h"

#include <algorithm>
#include <limits>
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

BoxTree BoxTree::of(std::span<const TileInfo> tiles) {
  std::vector<IndexBox> boxes;
  boxes.reserve(tiles.size());
  for (const TileInfo& tile : tiles) boxes.push_back(tile.box);
  return BoxTree(std::move(boxes));
}

BoxTree::NearestFirst::NearestFirst(const BoxTree& tree, const Lattice& lattice,
                                    const Index3& position)
    : tree_(tree), lattice_(lattice), position_{position, position} {
  if (!tree.levels_.front().empty()) push(tree.levels_.size() - 1, 0);
}

void BoxTree::NearestFirst::push(std::size_t level, std::size_t number) {
  const IndexBox& box = tree_.levels_[level][number];
  if (box.empty()) return;
  nodes_.push({pss::distance_sq(lattice_, position_, box), level, number});
}

void BoxTree::NearestFirst::open() {
  while (!nodes_.empty() && nodes_.top().level > 0) {
    const Node node = nodes_.top();
    nodes_.pop();
    const std::size_t first = node.number * kFanOut;
    const std::size_t end = std::min(first + kFanOut, tree_.levels_[node.level - 1].size());
    for (std::size_t child = first; child < end; ++child) push(node.level - 1, child);
  }
}

double BoxTree::NearestFirst::distance_sq() {
  open();
  return nodes_.empty() ? std::numeric_limits<double>::infinity() : nodes_.top().distance_sq;
}

std::size_t BoxTree::NearestFirst::take() {
  open();
  const std::size_t number = nodes_.top().number;
  nodes_.pop();
  return number;
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
