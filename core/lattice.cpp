#include "core/lattice.h"

#include <algorithm>
#include <cmath>

namespace pss {
namespace {

/// How far `p` lies outside [low, high] on one axis, in steps.
std::int64_t gap(std::int64_t p, std::int64_t low, std::int64_t high) {
  return p < low ? low - p : p > high ? p - high : 0;
}

}  // namespace

World3 to_world(const Lattice& lattice, const Index3& index) {
  World3 world;
  for (std::size_t a = 0; a < 3; ++a)
    world[a] = lattice.origin[a] + lattice.scale[a] * static_cast<double>(index[a]);
  return world;
}

Index3 to_index(const Lattice& lattice, const World3& world) {
  Index3 index;
  for (std::size_t a = 0; a < 3; ++a)
    index[a] = std::llrint((world[a] - lattice.origin[a]) / lattice.scale[a]);
  return index;
}

bool on_lattice(const Lattice& lattice, const World3& world) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double steps = (world[a] - lattice.origin[a]) / lattice.scale[a];
    if (!(std::abs(steps) <= static_cast<double>(kLatticeMax) - 1)) return false;  // also NaN
  }
  return true;
}

bool on_lattice(const Index3& index) {
  return std::ranges::all_of(index,
                             [](std::int64_t i) { return i >= kLatticeMin && i <= kLatticeMax; });
}

double distance_sq(const Lattice& lattice, const Index3& a, const Index3& b) {
  return length_sq(lattice.scale[0] * static_cast<double>(b[0] - a[0]),
                   lattice.scale[1] * static_cast<double>(b[1] - a[1]),
                   lattice.scale[2] * static_cast<double>(b[2] - a[2]));
}

void WorldBox::add(const World3& p) {
  for (std::size_t a = 0; a < 3; ++a) {
    min[a] = std::min(min[a], p[a]);
    max[a] = std::max(max[a], p[a]);
  }
}

void WorldBox::add(const WorldBox& b) {
  if (b.empty()) return;
  add(b.min);
  add(b.max);
}

bool WorldBox::contains(const World3& p) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (!(p[a] >= min[a] && p[a] <= max[a])) return false;
  return true;
}

WorldBox WorldBox::clipped(const WorldBox& b) const {
  WorldBox both;
  for (std::size_t a = 0; a < 3; ++a) {
    both.min[a] = std::max(min[a], b.min[a]);
    both.max[a] = std::min(max[a], b.max[a]);
    if (!(both.min[a] <= both.max[a])) return {};
  }
  return both;
}

void IndexBox::add(const Index3& p) {
  for (std::size_t a = 0; a < 3; ++a) {
    min[a] = std::min(min[a], p[a]);
    max[a] = std::max(max[a], p[a]);
  }
}

void IndexBox::add(const IndexBox& b) {
  if (b.empty()) return;
  add(b.min);
  add(b.max);
}

double distance_sq(const Lattice& lattice, const Index3& p, const IndexBox& box) {
  World3 d;
  for (std::size_t a = 0; a < 3; ++a)
    d[a] = lattice.scale[a] * static_cast<double>(gap(p[a], box.min[a], box.max[a]));
  return length_sq(d[0], d[1], d[2]);
}

double distance_sq(const Lattice& lattice, const IndexBox& a, const IndexBox& b) {
  World3 d;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t steps =
        std::max({std::int64_t{0}, b.min[i] - a.max[i], a.min[i] - b.max[i]});
    d[i] = lattice.scale[i] * static_cast<double>(steps);
  }
  return length_sq(d[0], d[1], d[2]);
}

Lattice lattice_for(const WorldBox& bounds) {
  if (bounds.empty()) return {};
  double side = 0;
  double largest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    side = std::max(side, bounds.max[a] - bounds.min[a]);
    largest = std::max({largest, std::abs(bounds.min[a]), std::abs(bounds.max[a])});
  }
  if (side == 0) side = largest;
  if (side == 0) return {};
  int exponent = 0;
  const double mantissa = std::frexp(side, &exponent);  // side = mantissa * 2^exponent
  if (mantissa == 0.5) --exponent;                      // a power of two is its own ceiling
  const double step = std::ldexp(1.0, exponent - 41);
  Lattice lattice{{step, step, step}, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    const double centre = bounds.min[a] / 2 + bounds.max[a] / 2;
    lattice.origin[a] = std::nearbyint(centre / step) * step;
  }
  return lattice;
}

}  // namespace pss
