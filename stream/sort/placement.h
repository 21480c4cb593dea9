#pragma once
// Puts the positions of one input onto the lattice that all inputs share.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "io/points/points.h"

namespace pss {

/// Lattice position = multiple * grid position + shift, an axis each: nothing is rounded.
struct GridMap {
  Index3 multiple{1, 1, 1};
  Index3 shift{0, 0, 0};

  bool operator==(const GridMap&) const = default;
};

/// How the grid of a file lies within the lattice; empty where its positions fall between steps.
///
/// Scales and offsets are decimal numbers in doubles: they align where they do to their last bits.
std::optional<GridMap> align(const Lattice& grid, const Lattice& lattice);

/// What became of a position.
enum class Placed : std::uint8_t { kExact, kMoved, kNotFinite, kOutside };

/// Thread: any number at once.
class Placement {
 public:
  /// `grid` is the file's own, where it has one.
  Placement(const std::optional<Lattice>& grid, const Lattice& lattice);

  /// Whether every position keeps its place.
  bool exact() const { return map_.has_value(); }

  /// Puts position `i` of the batch into `out`; `move` is how far it moved, in world units.
  Placed place(const PointBatch& batch, std::size_t i, Index3& out, double& move) const;

 private:
  Placed place_exactly(const Index3& index, Index3& out) const;
  Placed place_rounded(const Index3& index, Index3& out, double& move) const;
  Placed place_world(const World3& world, Index3& out, double& move) const;
  std::optional<Lattice> grid_;
  Lattice lattice_;
  std::optional<GridMap> map_;
};

}  // namespace pss
