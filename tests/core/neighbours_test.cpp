#include "core/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "tests/support/cloud.h"

namespace pss::test {
namespace {

/// All offsets within the ball, by the definition.
Offsets brute_force_ball(const Lattice& lattice, const std::vector<Index3>& points,
                         const Query& query, double radius) {
  Offsets out;
  for (const Index3& p : points) {
    World3 d;
    for (std::size_t a = 0; a < 3; ++a)
      d[a] = lattice.scale[a] * static_cast<double>(p[a] - query.position[a]) - query.remainder[a];
    if (std::fma(d[0], d[0], std::fma(d[1], d[1], d[2] * d[2])) >= radius * radius) continue;
    out.x.push_back(d[0]);
    out.y.push_back(d[1]);
    out.z.push_back(d[2]);
  }
  return out;
}

std::optional<double> brute_force_kth(const Lattice& lattice, const std::vector<Index3>& points,
                                      const Index3& position, int k, double cap) {
  const std::set<Index3> distinct(points.begin(), points.end());
  std::vector<double> distances;
  for (const Index3& p : distinct)
    if (p != position) distances.push_back(std::sqrt(distance_sq(lattice, position, p)));
  std::ranges::sort(distances);
  const auto rank = static_cast<std::size_t>(k - 1);
  if (rank >= distances.size() || distances[rank] > cap) return std::nullopt;
  return distances[rank];
}

void expect_same(const Offsets& a, const Offsets& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
}

/// Scales an axis, the radius that cells are made for, the radius that is asked for.
using Case = std::tuple<World3, double, double>;

class CellGridTest : public testing::TestWithParam<Case> {};

TEST_P(CellGridTest, GathersExactlyTheBallInKeyOrder) {
  const auto [scale, cell_radius, radius] = GetParam();
  const Lattice lattice{scale, {}};
  Random random(17);
  const std::vector<Index3> points = random_cube(random, 3000, 2000);
  const CellGrid grid(lattice, points, cell_radius);
  Offsets found;
  for (int i = 0; i < 50; ++i) {
    Query query{points[static_cast<std::size_t>(random.integer(0, 2999))]};
    if (i % 2) query.remainder = {0.37 * scale[0], -0.21 * scale[1], 12.5 * scale[2]};
    grid.gather(query, radius, found);
    expect_same(found, brute_force_ball(lattice, points, query, radius));
  }
}

TEST_P(CellGridTest, FindsTheKthDistinctDistance) {
  const auto [scale, cell_radius, radius] = GetParam();
  const Lattice lattice{scale, {}};
  Random random(18);
  std::vector<Index3> points = random_cube(random, 1500, 300);
  points.insert(points.end(), points.begin(), points.begin() + 700);  // copies
  points.insert(points.end(), 500, points.front());
  sort_by_key(points);
  const CellGrid grid(lattice, points, cell_radius);
  for (int i = 0; i < 6; ++i) {
    const Index3 position = i % 4 ? points[static_cast<std::size_t>(random.integer(0, 2699))]
                                  : Index3{random.integer(-200, 200), 3 * i, 10 * i};
    for (const int k : {1, 2, 16, 300, 1499, 1600})
      for (const double cap : {radius, 1e300})
        EXPECT_EQ(grid.kth_distance(position, k, cap),
                  brute_force_kth(lattice, points, position, k, cap))
            << "k " << k << " cap " << cap;
  }
}

/// The distances to all points but one at the position, ascending.
std::vector<double> other_distances(const Lattice& lattice, const std::vector<Index3>& points,
                                    const Index3& position) {
  std::vector<double> distances;
  for (const Index3& p : points) distances.push_back(std::sqrt(distance_sq(lattice, position, p)));
  std::ranges::sort(distances);
  distances.erase(distances.begin());
  return distances;
}

TEST_P(CellGridTest, FindsTheKthPointCountingDuplicates) {
  const auto [scale, cell_radius, radius] = GetParam();
  const Lattice lattice{scale, {}};
  Random random(23);
  std::vector<Index3> points = random_cube(random, 600, 2000);
  for (std::size_t i = 0; i < 600; i += 3) points.insert(points.end(), i % 30 ? 1 : 9, points[i]);
  std::ranges::sort(points, {}, encode_key);
  const CellGrid grid(lattice, points, cell_radius);
  for (std::size_t i = 0; i < points.size(); i += 11)
    for (const int k : {1, 4, 8, 30}) {
      const double expected =
          other_distances(lattice, points, points[i])[static_cast<std::size_t>(k - 1)];
      EXPECT_EQ(grid.kth_point_distance(points[i], k, 1e9), expected);
      if (expected == 0) continue;
      EXPECT_EQ(grid.kth_point_distance(points[i], k, expected), expected);
      EXPECT_EQ(grid.kth_point_distance(points[i], k, expected * (1 - 1e-9)), std::nullopt);
    }
}

TEST_P(CellGridTest, SumsWhatIsNearerThanTheRadius) {
  const auto [scale, cell_radius, radius] = GetParam();
  const Lattice lattice{scale, {}};
  Random random(29);
  std::vector<Index3> points = random_cube(random, 1500, 2000);
  for (std::size_t i = 0; i < 1500; i += 5) points.push_back(points[i]);
  std::ranges::sort(points, {}, encode_key);
  const CellGrid grid(lattice, points, cell_radius);
  for (std::size_t i = 0; i < points.size(); i += 37) {
    BallSum expected;
    for (const Index3& p : points) {
      const double distance = std::sqrt(distance_sq(lattice, points[i], p));
      if (distance >= radius) continue;
      ++expected.points;
      expected.distances += distance;
      expected.heights += static_cast<double>(p[2] - points[i][2]);
    }
    const BallSum found = grid.sum_ball(points[i], radius);
    EXPECT_EQ(found.points, expected.points);
    EXPECT_NEAR(found.distances, expected.distances, 1e-9 * expected.distances);
    EXPECT_EQ(found.heights, expected.heights);
  }
}

INSTANTIATE_TEST_SUITE_P(ScalesAndRadii, CellGridTest,
                         testing::Combine(testing::Values(World3{1, 1, 1},
                                                          World3{0.01, 0.01, 0.001},
                                                          World3{1e-3, 0.7, 1e3}),
                                          testing::Values(1e-4, 1.0, 130.0, 1e9),
                                          testing::Values(0.3, 4.0, 200.0, 5000.0)));

TEST(CellGrid, IncludesNothingAtExactlyTheRadius) {
  const std::vector<Index3> points{{0, 0, 0}, {3, 4, 0}};
  const CellGrid grid({}, points, 5);
  Offsets found;
  grid.gather({{0, 0, 0}}, 5, found);
  EXPECT_EQ(found.x, std::vector<double>{0});
  grid.gather({{0, 0, 0}}, std::nextafter(5.0, 6.0), found);
  EXPECT_EQ(found.y, (std::vector<double>{0, 4}));
}

TEST(CellGrid, TakesTheKthDistanceAtExactlyTheCap) {
  const std::vector<Index3> points{{0, 0, 0}, {3, 4, 0}};
  const CellGrid grid({}, points, 1);
  EXPECT_EQ(grid.kth_distance({0, 0, 0}, 1, 5), 5);
  EXPECT_EQ(grid.kth_distance({0, 0, 0}, 1, std::nextafter(5.0, 0.0)), std::nullopt);
}

TEST(CellGrid, FindsTheNearestPositionsByDistanceThenPlace) {
  const Lattice lattice{{1, 1, 0.5}, {}};
  Random random(18);
  std::vector<Index3> points =
      random_cube(random, 2000, 20);  // many at equal distances, and copies
  const CellGrid grid(lattice, points, 3);
  for (std::size_t i = 0; i < points.size(); i += 97) {
    std::set<Neighbour> expected;
    for (const Index3& p : points)
      if (p != points[i]) expected.insert({distance_sq(lattice, points[i], p), p});
    for (const std::size_t count : {1u, 16u, 200u, 5000u}) {
      const auto end = std::next(expected.begin(),
                                 static_cast<std::ptrdiff_t>(std::min(count, expected.size())));
      EXPECT_EQ(grid.nearest(points[i], count), std::vector<Neighbour>(expected.begin(), end));
    }
  }
}

TEST(CellGrid, WorksInTheCornersOfTheLattice) {
  std::vector<Index3> points;
  for (const std::int64_t x : {kLatticeMin, kLatticeMax})
    for (const std::int64_t y : {kLatticeMin, kLatticeMax})
      for (const std::int64_t z : {kLatticeMin, kLatticeMax}) points.push_back({x, y, z});
  sort_by_key(points);
  for (const double cells : {1.0, 1e12, 1e15}) {
    const CellGrid grid({}, points, cells);
    Offsets found;
    for (const Index3& p : points) {
      grid.gather({p}, 10, found);
      EXPECT_EQ(found.size(), 1u);
      grid.gather({p}, 1e14, found);
      EXPECT_EQ(found.size(), 8u);
      EXPECT_EQ(grid.kth_distance(p, 1, 1e300), 0x1p42 - 1);
      EXPECT_TRUE(grid.kth_distance(p, 7, std::numeric_limits<double>::infinity()).has_value());
    }
  }
}

TEST(CellGrid, FindsNothingInAnEmptyCloud) {
  const CellGrid grid({}, {}, 1);
  Offsets found;
  found.x = {1};
  grid.gather({}, 10, found);
  EXPECT_EQ(found.size(), 0u);
  EXPECT_EQ(grid.kth_distance({0, 0, 0}, 1, 1e300), std::nullopt);
}

TEST(CellGrid, PassesOverAHundredThousandCopiesInOneSearch) {
  std::vector<Index3> points(100000, Index3{5, 5, 5});
  Random random(3);
  const std::vector<Index3> others = random_cube(random, 1000, 100);
  points.insert(points.end(), others.begin(), others.end());
  sort_by_key(points);
  const CellGrid grid({}, points, 10);
  const std::optional<double> expected = brute_force_kth({}, points, {5, 5, 5}, 16, 1e300);
  for (int i = 0; i < 20000; ++i)  // scans of the copies would take minutes
    ASSERT_EQ(grid.kth_distance({5, 5, 5}, 16, 1e300), expected);
}

TEST(CellGrid, SeesTheSameBallWhateverElseIsInTheCloud) {
  const Lattice lattice{{0.5, 0.5, 0.25}, {}};
  Random random(5);
  const std::vector<Index3> all = random_cube(random, 4000, 400);
  const Query query{{10, -20, 30}};
  std::vector<Index3> near;
  for (const Index3& p : all)
    if (distance_sq(lattice, query.position, p) < 45 * 45) near.push_back(p);
  Offsets from_all;
  Offsets from_near;
  CellGrid(lattice, all, 40).gather(query, 40, from_all);
  CellGrid(lattice, near, 3).gather(query, 40, from_near);
  ASSERT_GT(from_all.size(), 100u);
  expect_same(from_all, from_near);
}

TEST(CellGrid, StaysWithinTheMemoryItPromises) {
  EXPECT_LE(CellGrid::bytes_for(1000000), 4u * 1000000);
}

}  // namespace
}  // namespace pss::test
