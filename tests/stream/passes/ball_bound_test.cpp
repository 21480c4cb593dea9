#include "stream/passes/ball_bound.h"

#include <gtest/gtest.h>

#include "core/neighbours.h"
#include "tests/support/cloud.h"

namespace pss::test {
namespace {

const Lattice kUneven{{0.01, 0.02, 0.005}, {0, 0, 0}};

/// A sheet with a thousand points more in one corner.
std::vector<Index3> sheet_with_a_dense_corner(std::uint64_t seed) {
  Random random(seed);
  std::vector<World3> world;
  for (int i = 0; i < 4000; ++i)
    world.push_back({random.uniform(-10, 10), random.uniform(-10, 10), 0.1 * random.normal()});
  for (int i = 0; i < 1000; ++i)
    world.push_back({random.uniform(9, 10), random.uniform(9, 10), 0.1 * random.normal()});
  return on_lattice_sorted(kUneven, world);
}

std::size_t largest_ball(const Lattice& lattice, const std::vector<Index3>& points, double radius) {
  const CellGrid grid(lattice, points, radius);
  Offsets ball;
  std::size_t largest = 0;
  for (const Index3& point : points) {
    grid.gather({point, {}}, radius, ball);
    largest = std::max(largest, ball.size());
  }
  return largest;
}

/// Of balls of one radius about all of the points; the grid suits `cell_radius`.
std::uint64_t bound_of(const Lattice& lattice, const std::vector<Index3>& points, double radius,
                       std::uint64_t enough, double cell_radius = 0.7) {
  const CellGrid grid(lattice, points, cell_radius);
  return ball_bound(
      grid, points, [&](std::size_t) { return radius; }, enough);
}

TEST(BallBound, IsNeverExceeded) {
  const std::vector<Index3> points = sheet_with_a_dense_corner(3);
  for (const double radius : {0.1, 0.7, 3.0, 50.0})
    EXPECT_GE(bound_of(kUneven, points, radius, 0), largest_ball(kUneven, points, radius))
        << radius;
}

TEST(BallBound, IsLessThanTwentyBallsWhereStepsAreEven) {
  const Lattice even{{0.01, 0.01, 0.01}, {0, 0, 0}};
  const std::vector<Index3> points = sheet_with_a_dense_corner(5);
  for (const double radius : {0.2, 0.7, 2.0})
    EXPECT_LE(bound_of(even, points, radius, 0, radius), 20 * largest_ball(even, points, radius))
        << radius;
}

TEST(BallBound, IsTheSameWhateverIsEnoughUpToIt) {
  const std::vector<Index3> points = sheet_with_a_dense_corner(4);
  const std::uint64_t fullest = bound_of(kUneven, points, 0.7, 0);

  EXPECT_EQ(bound_of(kUneven, points, 0.7, 10), fullest);
  EXPECT_EQ(bound_of(kUneven, points, 0.7, fullest - 1), fullest);
  EXPECT_EQ(bound_of(kUneven, points, 0.7, 5000), 5000u);
}

TEST(BallBound, HoldsForEqualPointsAndAtTheEndsOfTheLattice) {
  const std::vector<Index3> equal(100, Index3{5, 5, 5});
  std::vector<Index3> ends(100, {kLatticeMin, kLatticeMin, kLatticeMin});
  ends.insert(ends.end(), 100, {kLatticeMax, kLatticeMax, kLatticeMax});

  EXPECT_EQ(bound_of(kUneven, equal, 0, 0), 100u);
  EXPECT_EQ(bound_of(kUneven, ends, 0.001, 0), 100u);
  EXPECT_EQ(bound_of(kUneven, ends, 1e300, 0), 200u);
  EXPECT_EQ(bound_of(kUneven, {}, 1, 0), 0u);
}

}  // namespace
}  // namespace pss::test
