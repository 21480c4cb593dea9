#pragma once
// Which of many boxes lie near another: the tiles that a halo may reach into.

#include <cstddef>
#include <functional>
#include <queue>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "stream/store/manifest.h"

namespace pss {

/// A tree of bounding boxes over a sequence of boxes that lie roughly along a space-filling order.
///
/// Thread: const members from any number at once.
/// Cost:   48 bytes a box and one eighth more; a query visits O(log n + found) nodes.
class BoxTree {
 public:
  explicit BoxTree(std::vector<IndexBox> boxes);
  /// Over the measured boxes of tiles, by their numbers.
  static BoxTree of(std::span<const TileInfo> tiles);

  /// The boxes in the order of their distance from a position, nearest first, as far as is asked.
  ///
  /// Source: best-first search over boxes, Hjaltason, Samet, "Distance Browsing in Spatial
  /// Databases", 1999.
  class NearestFirst {
   public:
    /// Requires: the tree outlives it.
    NearestFirst(const BoxTree& tree, const Lattice& lattice, const Index3& position);
    /// The squared distance of the next box; infinity where there is none.
    double distance_sq();
    /// The number of the next box. Requires: there is one.
    std::size_t take();

   private:
    struct Node {
      double distance_sq;
      std::size_t level;
      std::size_t number;
      bool operator>(const Node& other) const { return distance_sq > other.distance_sq; }
    };
    void push(std::size_t level, std::size_t number);
    /// Opens nodes until a box is the nearest.
    void open();
    const BoxTree& tree_;
    const Lattice& lattice_;
    IndexBox position_;
    std::priority_queue<Node, std::vector<Node>, std::greater<>> nodes_;
  };

  /// The numbers of all boxes whose distance to `box` is at most `reach`, ascending.
  std::vector<std::size_t> within(const Lattice& lattice, const IndexBox& box, double reach) const;

 private:
  static constexpr std::size_t kFanOut = 8;
  void collect(std::size_t level, std::size_t node, const Lattice& lattice, const IndexBox& box,
               double reach_sq, std::vector<std::size_t>& found) const;

  std::vector<std::vector<IndexBox>> levels_;  ///< levels_[0] are the boxes, the last is the root
};

}  // namespace pss
