#pragma once
// Finds the points of a key-sorted cloud within a ball, always in key order.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/morton.h"
#include "core/nearest_positions.h"

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

/// Consecutive points of a cloud.
struct PointRange {
  std::size_t begin;
  std::size_t end;
};

/// What lies in a ball about a position, summed up.
struct BallSum {
  std::uint64_t points = 0;
  double distances = 0;  ///< from the position, summed in key order
  double heights = 0;    ///< along the third axis, in steps of the lattice
};

/// Power-of-two cells over points that are sorted by key.
///
/// Every result depends only on the points within the ball that is asked for, never on the cell
/// size or on what else is in the cloud.
class CellGrid {
 public:
  /// Cells sized for balls of about `radius`.
  ///
  /// Requires: `points` sorted by key, on the lattice, fewer than 2^32, outliving the grid;
  ///           radius > 0.
  /// Cost:     O(n).
  CellGrid(const Lattice& lattice, std::span<const Index3> points, double radius);

  /// Replaces `out` by the offsets of all points with |p - query|^2 < radius^2, in key order.
  ///
  /// Units:  world units, relative to the query (its remainder subtracted after conversion).
  /// Thread: any number at once.
  /// Cost:   at most 27 searches and the points of the cells that the ball touches, whatever the
  ///         radius; `out` allocates only while it grows.
  void gather(const Query& query, double radius, Offsets& out) const;

  /// Replaces `out` by ascending ranges of points that hold all within `radius` of the box, and
  /// as few others as cells allow.
  ///
  /// Requires: a box that is not empty.
  /// Thread:   any number at once.
  /// Cost:     searches in proportion to the cells that are touched.
  void gather_ranges(const IndexBox& box, double radius, std::vector<PointRange>& out) const;

  const Lattice& lattice() const { return lattice_; }
  std::span<const Index3> points() const { return points_; }

  /// The distance from a position to the k-th nearest distinct position, its own excluded.
  ///
  /// Empty when fewer than k distinct positions lie within `cap` (distance <= cap), which may be
  /// infinite.
  ///
  /// Requires: k >= 1; `position` on the lattice, in the cloud or not.
  /// Thread:   any number at once.
  /// Cost:     about that of one to three balls that hold k positions; copies of a position count
  ///           as one search.
  std::optional<double> kth_distance(const Index3& position, int k, double cap) const;

  /// The same to the k-th nearest point, where duplicates count each: of the points at the position
  /// itself all but one do. Requires: a position of the cloud.
  std::optional<double> kth_point_distance(const Index3& position, int k, double cap) const;

  /// The sums over all points whose distance is less than `radius`, those at the position included.
  ///
  /// Thread: any number at once.
  /// Cost:   that of gather(), but that duplicates count as one search; allocates nothing.
  BallSum sum_ball(const Index3& position, double radius) const;

  /// The `count` distinct positions that are nearest to one, its own excluded, in the order of
  /// Neighbour; all, where there are fewer.
  ///
  /// Requires, Thread, Cost: as kth_distance(); and sorting them.
  std::vector<Neighbour> nearest(const Index3& position, std::size_t count) const;

  /// What a grid over `points` points allocates at most.
  static std::size_t bytes_for(std::size_t points);

 private:
  struct Entry {
    Key first;  // of the cell, not of a point
    std::uint32_t begin;
    std::uint32_t place;  // the lowest 10 bits of its number along each axis
  };

  class BoxSearch;
  template <class Visit>
  void visit_ball(const Query& query, double radius, Visit visit) const;
  template <class Nearest>
  void add_distances(const Index3& position, double radius, Nearest& nearest) const;
  template <class Nearest>
  void search(const Index3& position, int k, double cap, Nearest& nearest) const;
  std::size_t lower_bound(const Key& key, int shift, std::size_t& entry) const;
  std::size_t end_of(std::size_t entry) const;
  std::size_t end_of_copies(std::size_t i, std::size_t end) const;
  double first_guess(const Index3& position, int k) const;

  Lattice lattice_;
  std::span<const Index3> points_;
  int shift_ = 0;  // the cells' sides are 2^shift_ steps
  std::vector<Entry> cells_;
};

}  // namespace pss
