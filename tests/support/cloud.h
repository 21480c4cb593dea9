#pragma once
// Small clouds for tests: seeded random numbers, points on a lattice in key order.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/morton.h"

namespace pss::test {

/// A small seeded generator (splitmix64), the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  /// Evenly distributed in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  std::int64_t integer(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(next() % static_cast<std::uint64_t>(high - low + 1));
  }
  /// Mean 0, variance 1, from twelve uniform numbers: exact moments are all that tests need.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
};

inline void sort_by_key(std::vector<Index3>& points) {
  std::ranges::sort(points, {}, [](const Index3& p) { return encode_key(p); });
}

/// `count` positions in the cube [-side/2, side/2] of steps, in key order.
inline std::vector<Index3> random_cube(Random& random, std::size_t count, std::int64_t side) {
  std::vector<Index3> points(count);
  for (Index3& p : points)
    for (std::int64_t& c : p) c = random.integer(-side / 2, side / 2);
  sort_by_key(points);
  return points;
}

/// The nearest lattice positions, in key order.
inline std::vector<Index3> on_lattice_sorted(const Lattice& lattice,
                                             std::span<const World3> world) {
  std::vector<Index3> points;
  points.reserve(world.size());
  for (const World3& p : world) points.push_back(to_index(lattice, p));
  sort_by_key(points);
  return points;
}

}  // namespace pss::test
