#include "stream/ball_bound.h"

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

TEST(BallBound, IsNeverExceeded) {
  const std::vector<Index3> points = sheet_with_a_dense_corner(3);
  for (const double radius : {0.1, 0.7, 3.0, 50.0})
    EXPECT_GE(ball_bound(kUneven, points, radius, 0), largest_ball(kUneven, points, radius))
        << radius;
}

TEST(BallBound, IsLessThanTwentyBallsWhereStepsAreEven) {
  const Lattice even{{0.01, 0.01, 0.01}, {0, 0, 0}};
  const std::vector<Index3> points = sheet_with_a_dense_corner(5);
  for (const double radius : {0.2, 0.7, 2.0})
    EXPECT_LE(ball_bound(even, points, radius, 0), 20 * largest_ball(even, points, radius))
        << radius;
}

TEST(BallBound, IsCoarseOnlyWhereThatIsEnough) {
  const std::vector<Index3> points = sheet_with_a_dense_corner(4);
  const std::uint64_t exact = ball_bound(kUneven, points, 0.7, 0);

  EXPECT_LE(ball_bound(kUneven, points, 0.7, 3000), 3000u);
  EXPECT_EQ(ball_bound(kUneven, points, 0.7, exact - 1), exact);
  EXPECT_EQ(ball_bound(kUneven, points, 0.7, 5000), 5000u) << "no more than there are";
}

TEST(BallBound, HoldsForEqualPointsAndAtTheEndsOfTheLattice) {
  const std::vector<Index3> equal(100, Index3{5, 5, 5});
  const std::vector<Index3> ends{{kLatticeMin, kLatticeMin, kLatticeMin},
                                 {kLatticeMax, kLatticeMax, kLatticeMax}};

  EXPECT_EQ(ball_bound(kUneven, equal, 0, 0), 100u);
  EXPECT_EQ(ball_bound(kUneven, ends, 0.001, 0), 1u);
  EXPECT_EQ(ball_bound(kUneven, ends, 1e300, 0), 2u);
  EXPECT_EQ(ball_bound(kUneven, {}, 1, 0), 0u);
}

}  // namespace
}  // namespace pss::test
