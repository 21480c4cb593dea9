#pragma once
// Which of many boxes lie near another: the tiles that a halo may reach into.

#include <cstddef>
#include <vector>

#include "core/lattice.h"

namespace pss {

/// A tree of bounding boxes over a sequence of boxes that lie roughly along a space-filling order.
///
/// Thread: const members from any number at once.
/// Cost:   48 bytes a box and one eighth more; a query visits O(log n + found) nodes.
class BoxTree {
 public:
  explicit BoxTree(std::vector<IndexBox> boxes);

  /// The numbers of all boxes whose distance to `box` is at most `reach`, ascending.
  std::vector<std::size_t> within(const Lattice& lattice, const IndexBox& box, double reach) const;

 private:
  static constexpr std::size_t kFanOut = 8;
  void collect(std::size_t level, std::size_t node, const Lattice& lattice, const IndexBox& box,
               double reach_sq, std::vector<std::size_t>& found) const;

  std::vector<std::vector<IndexBox>> levels_;  ///< levels_[0] are the boxes, the last is the root
};

}  // namespace pss
