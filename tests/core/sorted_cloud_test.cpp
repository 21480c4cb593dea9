#include "core/sorted_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/morton.h"
#include "tests/support/cloud.h"

namespace pss::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<World3> random_points(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<World3> points(count);
  for (World3& p : points) p = {random.uniform(-1, 1), random.uniform(2, 5), random.uniform()};
  return points;
}

/// A normal that tells the point that it belongs to.
Normal normal_of(const World3& p) { return unit_normal(p); }

/// A square grid of side^2 points `step` apart.
std::vector<World3> square_grid(int side, double step) {
  std::vector<World3> points;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) points.push_back({step * i, step * j, 0});
  return points;
}

TEST(SortedCloud, HasThePointsInKeyOrderAndTheWayBack) {
  const std::vector<World3> points = random_points(500, 1);
  const SortedCloud cloud = sort_cloud(points).value();
  EXPECT_TRUE(std::ranges::is_sorted(cloud.points, {}, encode_key));
  std::vector<int> seen(points.size(), 0);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_EQ(cloud.points[i], to_index(cloud.lattice, points[cloud.order[i]]));
    ++seen[cloud.order[i]];
  }
  EXPECT_EQ(seen, std::vector<int>(points.size(), 1));
}

TEST(SortedCloud, CarriesEachNormalWithItsPoint) {
  const std::vector<World3> points = random_points(500, 2);
  std::vector<Normal> normals;
  for (const World3& p : points) normals.push_back(normal_of(p));
  const SortedCloud cloud = sort_cloud(points, normals).value();
  ASSERT_EQ(cloud.normals.size(), points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(cloud.normals[i][a], normal_of(points[cloud.order[i]])[a], 1e-7);
}

TEST(SortedCloud, DependsNotOnTheOrderOfPointsAtOnePosition) {
  const std::vector<World3> points(3, World3{1, 2, 3});
  const std::vector<Normal> normals{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Normal> others{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(sort_cloud(points, normals).value().normals,
            sort_cloud(points, others).value().normals);
}

TEST(SortedCloud, RoundsToAFineLatticeAroundThePoints) {
  const std::vector<World3> points = random_points(500, 3);
  const SortedCloud cloud = sort_cloud(points).value();
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(to_world(cloud.lattice, cloud.points[i])[a], points[cloud.order[i]][a], 3e-12);
}

TEST(SortedCloud, RefusesAPointSoFarAwayThatTheOthersWouldBecomeOne) {
  for (const int side : {30, 100}) {
    std::vector<World3> points = square_grid(side, 1);
    // A side of 2^34 gives steps of 2^-7, a longer one steps of 2^-6; the spacing is 0.99.
    points.insert(points.begin() + 17, {0, 0, 0x1p34});
    EXPECT_TRUE(sort_cloud(points).has_value());
    points[17][2] += 1;
    const auto refused = sort_cloud(points);
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().fault, Fault::kBadInput);
    EXPECT_TRUE(refused.error().message.starts_with("point 17: ")) << refused.error().message;
    EXPECT_TRUE(sort_cloud(points, {}, Lattice{{0.25, 0.25, 0.25}, {0, 0, 0}}).has_value());
  }
}

TEST(SortedCloud, TakesTheLatticeThatItIsGiven) {
  const Lattice lattice{{0.01, 0.01, 0.001}, {500000, 4000000, 0}};
  const std::vector<World3> points{to_world(lattice, {7, -9, 12345}), to_world(lattice, {0, 1, 2})};
  const SortedCloud cloud = sort_cloud(points, {}, lattice).value();
  EXPECT_EQ(cloud.lattice, lattice);
  EXPECT_TRUE(std::ranges::count(cloud.points, Index3{7, -9, 12345}) == 1);
}

TEST(SortedCloud, OfNoPointsIsEmpty) {
  const SortedCloud cloud = sort_cloud({}).value();
  EXPECT_TRUE(cloud.points.empty());
  EXPECT_FALSE(spacing_of(cloud).has_value());
}

TEST(SortedCloud, NamesThePointThatIsNotFinite) {
  for (const double bad : {kNaN, HUGE_VAL, -HUGE_VAL, 1e300}) {
    std::vector<World3> points = random_points(10, 4);
    points[7][1] = bad;
    const Result<SortedCloud> cloud = sort_cloud(points);
    ASSERT_FALSE(cloud);
    EXPECT_EQ(cloud.error().fault, Fault::kBadInput);
    EXPECT_TRUE(cloud.error().message.starts_with("point 7: ")) << cloud.error().message;
  }
}

TEST(SortedCloud, NamesThePointThatTheLatticeDoesNotHold) {
  const Lattice lattice{{1e-9, 1e-9, 1e-9}, {0, 0, 0}};
  const Result<SortedCloud> cloud = sort_cloud({{{0, 0, 0}, {0, 1e6, 0}}}, {}, lattice);
  ASSERT_FALSE(cloud);
  EXPECT_TRUE(cloud.error().message.starts_with("point 1: ")) << cloud.error().message;
}

TEST(SortedCloud, MakesNormalsUnit) {
  const std::vector<World3> points = random_points(4, 5);
  const std::vector<Normal> normals{{0, 0, -1}, {3, 0, 4}, {0, 0, 0}, {0, 1e30f, 0}};
  const SortedCloud cloud = sort_cloud(points, normals).value();
  const Normal expected[] = {{0, 0, -1}, {0.6f, 0, 0.8f}, {0, 0, 0}, {0, 1, 0}};
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(cloud.normals[i], expected[cloud.order[i]]);
}

TEST(SortedCloud, RefusesNormalsThatAreNone) {
  const std::vector<World3> points = random_points(2, 5);
  for (const Normal bad : {Normal{0, 0, static_cast<float>(kNaN)}, Normal{HUGE_VALF, 0, 0}}) {
    const Result<SortedCloud> cloud = sort_cloud(points, std::vector<Normal>{{0, 0, 1}, bad});
    ASSERT_FALSE(cloud);
    EXPECT_TRUE(cloud.error().message.starts_with("normal 1: ")) << cloud.error().message;
  }
  EXPECT_FALSE(sort_cloud(points, std::vector<Normal>{{0, 0, 1}}));
}

// Around a point of a square grid, 4 others lie at 1, 4 at sqrt(2), 4 at 2 and 8 at sqrt(5) steps.
TEST(SpacingOf, ASquareGridFollowsFromItsSixteenthNeighbour) {
  const double step = 0.3;
  const SortedCloud cloud = sort_cloud(square_grid(60, step)).value();
  EXPECT_NEAR(spacing_of(cloud).value(), step * std::sqrt(5 * std::numbers::pi / 16), 1e-9);
}

TEST(SpacingOf, ACloudWithCopiesIsThatOfItsPositions) {
  std::vector<World3> points = square_grid(60, 0.3);
  const double once = spacing_of(sort_cloud(points).value()).value();
  for (int copy = 0; copy < 50; ++copy)
    points.insert(points.end(), points.begin(), points.begin() + 200);
  EXPECT_EQ(spacing_of(sort_cloud(points).value()).value(), once);
}

TEST(SpacingOf, FewerThanSeventeenPositionsIsNone) {
  std::vector<World3> points = square_grid(4, 1);
  points.insert(points.end(), points.begin(), points.begin() + 16);
  EXPECT_FALSE(spacing_of(sort_cloud(points).value()).has_value());
  points.push_back({9, 9, 9});
  EXPECT_TRUE(spacing_of(sort_cloud(points).value()).has_value());
}

}  // namespace
}  // namespace pss::test
