#pragma once
// The global grid of positions: integers, a scale an axis and an origin.

#include <array>
#include <cmath>
#include <cstdint>

#include "core/result.h"

namespace pss {

/// A position, or a difference of positions, in world units.
using World3 = std::array<double, 3>;
/// A position on a lattice, in steps from its origin.
using Index3 = std::array<std::int64_t, 3>;

/// Bits an axis: a lattice position lies in [-2^41, 2^41).
inline constexpr int kLatticeBits = 42;
inline constexpr std::int64_t kLatticeMin = -(std::int64_t{1} << (kLatticeBits - 1));
inline constexpr std::int64_t kLatticeMax = (std::int64_t{1} << (kLatticeBits - 1)) - 1;

/// Maps lattice positions to the world: world = origin + scale * index.
///
/// Lengths are always formed as scale * (integer difference), so that they depend on neither the
/// origin nor the magnitude of the coordinates.
struct Lattice {
  World3 scale{1, 1, 1};
  World3 origin{0, 0, 0};

  bool operator==(const Lattice&) const = default;
};

World3 to_world(const Lattice& lattice, const Index3& index);

/// The nearest lattice position; the caller checks `on_lattice` first where the input is
/// distrusted.
Index3 to_index(const Lattice& lattice, const World3& world);

/// Whether `world` is finite and its nearest position lies within the lattice's bits.
bool on_lattice(const Lattice& lattice, const World3& world);
bool on_lattice(const Index3& index);

/// The one formula for a squared length that every neighbourhood decision uses.
inline double length_sq(double dx, double dy, double dz) {
  return std::fma(dx, dx, std::fma(dy, dy, dz * dz));
}

/// |b - a|^2 in world units, by length_sq.
double distance_sq(const Lattice& lattice, const Index3& a, const Index3& b);

/// An axis-aligned box in world units; empty while min > max.
struct WorldBox {
  World3 min{1e308, 1e308, 1e308};
  World3 max{-1e308, -1e308, -1e308};

  bool empty() const { return min[0] > max[0]; }
  void add(const World3& p);
  void add(const WorldBox& b);
  /// Whether a position lies inside or on the border; one that is not a number does not.
  bool contains(const World3& p) const;
  /// What both boxes hold; empty where they do not meet.
  WorldBox clipped(const WorldBox& b) const;
  bool operator==(const WorldBox&) const = default;
};

/// A closed box of lattice positions; empty while min > max.
struct IndexBox {
  Index3 min{kLatticeMax, kLatticeMax, kLatticeMax};
  Index3 max{kLatticeMin, kLatticeMin, kLatticeMin};

  bool empty() const { return min[0] > max[0]; }
  void add(const Index3& p);
  void add(const IndexBox& b);
  bool operator==(const IndexBox&) const = default;
};

/// The squared distance from a position to a box (0 inside), and between two boxes, in world units.
/// Never more than the distance_sq of any point of the box, by the same rounding.
double distance_sq(const Lattice& lattice, const Index3& p, const IndexBox& box);
double distance_sq(const Lattice& lattice, const IndexBox& a, const IndexBox& b);

/// The lattice for floating-point positions within `bounds`: one step for all axes, the power of
/// two at or above (longest side) * 2^-41, and the multiple of it nearest the box's centre as
/// origin.
///
/// A box without extent takes its largest |coordinate| as its side; that 0 too gives step 1.
Lattice lattice_for(const WorldBox& bounds);

}  // namespace pss
