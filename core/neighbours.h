#pragma once
// Finds the points of a key-sorted cloud within a ball, always in key order.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/morton.h"

namespace pss {

/// A place to evaluate at: a lattice position and what rounding to the lattice cut off.
struct Query {
  Index3 position{};
  World3 remainder{0, 0, 0};
};

/// Offsets from a query to its neighbours, one array an axis, in key order.
struct Offsets {
  std::vector<double> x, y, z;

  std::size_t size() const { return x.size(); }
  void clear();
};

/// Power-of-two cells over points that are sorted by key.
///
/// Every result depends only on the points within the ball that is asked for, never on the cell
/// size or on what else is in the cloud.
class CellGrid {
 public:
  /// Cells sized for balls of about `radius`.
  ///
  /// Requires: `points` sorted by key, on the lattice, outliving the grid; radius > 0.
  CellGrid(const Lattice& lattice, std::span<const Index3> points, double radius);

  /// Replaces `out` by the offsets of all points with |p - query|^2 < radius^2, in key order.
  ///
  /// Units:  world units, relative to the query (its remainder subtracted after conversion).
  /// Thread: any number at once.
  void gather(const Query& query, double radius, Offsets& out) const;

  /// The distance from a position to the k-th nearest distinct position, its own excluded.
  ///
  /// Empty when fewer than k distinct positions lie within `cap` (distance <= cap).
  std::optional<double> kth_distance(const Index3& position, int k, double cap) const;

  /// What a grid over `points` points allocates at most.
  static std::size_t bytes_for(std::size_t points);

 private:
  struct Entry {
    Key first;
    std::uint32_t begin;
  };
  Lattice lattice_;
  std::span<const Index3> points_;
  int level_ = 0;
  std::vector<Entry> cells_;
};

}  // namespace pss
