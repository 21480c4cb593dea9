#pragma once
// A cheap test that spares the exact distance to most points of a block.

#include "core/lattice.h"

namespace pss {

/// Whether distance_sq(lattice, a, b) is above `limit_sq` for certain: never true where it is not.
///
/// Plain arithmetic, which compilers turn into vector instructions, is within a few roundings of
/// distance_sq.
inline bool surely_farther(const Lattice& lattice, const Index3& a, const Index3& b,
                           double limit_sq) {
  constexpr double kRoundings = 1 + 0x1p-48;
  const double dx = lattice.scale[0] * static_cast<double>(b[0] - a[0]);
  const double dy = lattice.scale[1] * static_cast<double>(b[1] - a[1]);
  const double dz = lattice.scale[2] * static_cast<double>(b[2] - a[2]);
  return dx * dx + dy * dy + dz * dz > limit_sq * kRoundings;
}

}  // namespace pss
