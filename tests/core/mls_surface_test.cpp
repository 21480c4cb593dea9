#include "core/mls_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "tests/core/mls_fixture.h"
#include "tests/support/batches.h"

namespace pss::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
  return order;
}

template <class T>
std::vector<T> picked(const std::vector<T>& from, const std::vector<std::size_t>& order) {
  std::vector<T> result;
  for (const std::size_t i : order) result.push_back(from[i]);
  return result;
}

std::vector<Projection> results_of(const std::vector<World3>& points, const MlsOptions& options) {
  return surface_over(points, options).project_points();
}

TEST(MlsSurface, GivesWhatAProjectorGivesOverTheSortedPoints) {
  const std::vector<World3> points = noisy_torus(0.1, 0.01);
  const MlsSurface surface = surface_over(points, {.h = 0.2});
  const std::vector<Index3> sorted = on_lattice_sorted(surface.lattice(), points);
  const CellGrid grid(surface.lattice(), sorted, 0.7);
  std::vector<Query> queries;
  for (const World3& p : points) queries.push_back({to_index(surface.lattice(), p), {}});
  std::vector<Projection> expected(points.size());
  const Support support{0.2, 0.6000000000000001};  // 3 * 0.2
  Projector(grid, Method{}, {}).project(queries, {&support, 1}, expected);
  EXPECT_EQ(count_different(surface.project_points(), expected), 0u);
}

TEST(MlsSurface, AnswersInTheOrderOfTheQueries) {
  const std::vector<World3> points = noisy_torus(0.1, 0.01);
  const std::vector<World3> queries = noisy_torus(0.1, 0.05, 12);
  const std::vector<std::size_t> order = shuffled(queries.size(), 1);
  const MlsSurface surface = surface_over(points, {.h = 0.2});
  const Projected straight = surface.project(queries);
  const Projected mixed = surface.project(picked(queries, order));
  EXPECT_EQ(mixed.positions, picked(straight.positions, order));
  EXPECT_EQ(count_different(mixed.results, picked(straight.results, order)), 0u);
}

TEST(MlsSurface, DependsNotOnTheOrderOfItsPoints) {
  const std::vector<World3> points = noisy_torus(0.1, 0.01);
  const std::vector<std::size_t> order = shuffled(points.size(), 2);
  for (const MlsOptions& options :
       {MlsOptions{}, MlsOptions{.h = 0.2}, MlsOptions{.knn = 20},
        MlsOptions{.method = {.op = MlsOperator::kApss}, .h = 0.2},
        MlsOptions{.method = {.op = MlsOperator::kRimls}, .h = 0.2},
        MlsOptions{.method = {.op = MlsOperator::kFast, .precision = Precision::kSingle}}}) {
    const std::vector<Projection> mixed = results_of(picked(points, order), options);
    EXPECT_EQ(count_different(mixed, picked(results_of(points, options), order)), 0u);
  }
}

TEST(MlsSurface, DependsNotOnTheThreads) {
  const std::vector<World3> points = noisy_torus(0.07, 0.01);
  const auto with_threads = [&](int count) {
    const ThreadLimit limit(count);
    return results_of(points, {.knn = 30});
  };
  EXPECT_EQ(count_different(with_threads(1), with_threads(2)), 0u);
}

TEST(MlsSurface, StillAnswersAfterAMove) {
  const std::vector<World3> points = noisy_torus(0.1, 0.01);
  MlsSurface first = surface_over(points, {.h = 0.2});
  const std::vector<Projection> before = first.project_points();
  const MlsSurface second = std::move(first);
  EXPECT_EQ(count_different(second.project_points(), before), 0u);
}

// The bound is the error on a sphere of the tube's radius rho, h^4 / (4 rho^3): a torus bends less.
TEST(MlsSurface, CarriesQueriesOffTheCloudOntoTheTorus) {
  const Torus torus;
  const double h = 0.1;
  const double bound = std::pow(h, 4) / (4 * std::pow(torus.minor, 3));
  const MlsSurface surface = surface_over(noisy_torus(0.04, 0), {.h = h});
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint on = surface_point(torus, random.uniform(), random.uniform());
    const World3 query = on.position + 0.4 * h * random.uniform(-1, 1) * on.normal;
    const Projected projected = surface.project({&query, 1});
    ASSERT_EQ(projected.results[0].status, Status::kOk);
    EXPECT_LT(std::abs(foot_of(torus, projected.positions[0]).distance), bound);
  }
}

TEST(MlsSurface, EvaluatesQueriesBetweenTheStepsOfACoarseLattice) {
  const double h = 0.2;
  const Lattice coarse{{h / 8, h / 8, h / 8}, {0, 0, 0}};
  const MlsSurface surface = surface_over(noisy_torus(0.04, 0), {.h = h, .lattice = coarse});
  const Projected once = surface.project(noisy_torus(0.1, 0.02, 13));
  const Projected twice = surface.project(once.positions);
  std::size_t same_foot = 0;
  for (std::size_t i = 0; i < once.positions.size(); ++i) {
    const World3 d = twice.positions[i] - once.positions[i];
    same_foot += std::sqrt(dot(d, d)) < 1e-11 ? 1 : 0;
  }
  EXPECT_GT(same_foot, 0.99 * static_cast<double>(once.positions.size()));
}

TEST(MlsSurface, MayWritePositionsOverTheQueries) {
  const std::vector<World3> queries = noisy_torus(0.1, 0.03, 14);
  const MlsSurface surface = surface_over(noisy_torus(0.1, 0.01), {.h = 0.2});
  std::vector<World3> places = queries;
  surface.project(places, places, {});
  EXPECT_EQ(places, surface.project(queries).positions);
}

TEST(MlsSurface, GivesEqualQueriesEqualAnswers) {
  const std::vector<World3> queries = noisy_torus(0.3, 0.03, 15);
  std::vector<World3> thrice = queries;
  for (int copy = 0; copy < 2; ++copy) thrice.insert(thrice.end(), queries.begin(), queries.end());
  const MlsSurface surface = surface_over(noisy_torus(0.1, 0.01), {.h = 0.2});
  const std::vector<Projection> once = surface.project(queries).results;
  const std::vector<Projection> all = surface.project(thrice).results;
  for (std::size_t copy = 0; copy < 3; ++copy) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(copy * queries.size());
    EXPECT_EQ(count_different({begin, begin + static_cast<std::ptrdiff_t>(queries.size())}, once),
              0u);
  }
}

TEST(MlsSurface, LeavesFewPointsWhereTheyAre) {
  const std::vector<World3> three{{0.1, 0.2, 0.3}, {0.4, 0.1, 0.3}, {0.1, 0.1, 0.1}};
  for (std::size_t count = 0; count < 3; ++count) {
    const std::vector<World3> points(three.begin(), three.begin() + static_cast<long>(count));
    for (const MlsOptions& options : {MlsOptions{}, MlsOptions{.h = 1}, MlsOptions{.knn = 4}}) {
      const Projected smoothed = smooth(points, options).value();
      EXPECT_EQ(smoothed.positions, points);
      for (const Projection& p : smoothed.results) EXPECT_FALSE(moved(p.status));
    }
  }
}

TEST(MlsSurface, LeavesWhatHasNoPlaneWhereItIs) {
  const std::vector<World3> same(50, World3{0.1, 0.2, 0.3});
  std::vector<World3> line;
  for (int i = 0; i < 50; ++i) line.push_back({0.1 * i, 0.2 * i, 0});
  for (const std::vector<World3>& points : {same, line}) {
    const Projected smoothed = smooth(points, {.h = 1}).value();
    EXPECT_EQ(smoothed.positions, points);
    for (const Projection& p : smoothed.results) EXPECT_EQ(p.status, Status::kDegenerate);
  }
}

TEST(MlsSurface, LeavesQueriesFarFromAllPointsWhereTheyAre) {
  const double inf = HUGE_VAL;
  const std::vector<World3> queries{{9, 0, 0},     {0, -1e200, 0},      {1e308, 0, -1e308},
                                    {0, inf, 0},   {-inf, inf, inf},    {kNaN, 0.5, 0.5},
                                    {0.5, 0.5, 1}, {kNaN, kNaN, -kNaN}, {0.5, 0.5, 1e-320 + 2}};
  for (const MlsOptions& options : {MlsOptions{.h = 0.2}, MlsOptions{.radius = 0.6, .knn = 8}}) {
    const Projected projected = surface_over(small_square(), options).project(queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      EXPECT_EQ(projected.results[i].status, options.knn ? Status::kIsolated : Status::kTooFew);
      EXPECT_EQ(projected.results[i].displacement, (World3{0, 0, 0}));
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_TRUE(projected.positions[i][a] == queries[i][a] || std::isnan(queries[i][a]));
    }
  }
}

// The lattice around a cloud reaches half its longest side beyond it; wide queries look farther.
TEST(MlsSurface, CarriesQueriesFromBeyondTheLattice) {
  const MlsSurface surface = surface_over(small_square(), {.h = 10});
  const std::vector<World3> queries{{0.5, 0.5, 4}, {0.5, 0.5, -3.7}, {0.4, 0.6, 1.5}};
  for (const World3& query : queries) EXPECT_FALSE(on_lattice(surface.lattice(), query));
  const Projected projected = surface.project(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    EXPECT_TRUE(moved(projected.results[i].status));
    EXPECT_EQ(projected.results[i].neighbours, 25u);
    EXPECT_NEAR(projected.positions[i][0], queries[i][0], 1e-9);
    EXPECT_NEAR(projected.positions[i][2], 0, 1e-9);
  }
}

TEST(MlsSurface, LooksAsFarAsTheNeighbourThatItIsTold) {
  const std::vector<World3> points = noisy_torus(0.15, 0.01);
  const std::vector<Projection> by_rank = results_of(points, {.knn = 24});
  for (std::size_t i = 0; i < points.size(); i += 40) {
    std::vector<double> distances;
    for (const World3& p : points)
      distances.push_back(std::sqrt(dot(p - points[i], p - points[i])));
    std::ranges::sort(distances);  // the first is the point itself
    const Projection alone = results_of(points, {.radius = distances[24]})[i];
    EXPECT_EQ(by_rank[i].status, alone.status);
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(by_rank[i].displacement[a], alone.displacement[a], 1e-9);
  }
}

/// The surface by an operator with normals that were computed, and with the same ones given.
class OperatorsWithNormals : public testing::TestWithParam<MlsOperator> {};
INSTANTIATE_TEST_SUITE_P(MlsSurface, OperatorsWithNormals,
                         testing::Values(MlsOperator::kApss, MlsOperator::kRimls));

TEST_P(OperatorsWithNormals, ComputeThoseThatAreNotGiven) {
  const std::vector<World3> points = noisy_torus(0.1, 0.01);
  std::vector<Normal> normals;
  for (const Projection& p : results_of(points, {.method = {.degree = 2}, .h = 0.2}))
    normals.push_back({static_cast<float>(p.normal[0]), static_cast<float>(p.normal[1]),
                       static_cast<float>(p.normal[2])});
  const MlsOptions options{.method = {.op = GetParam()}, .h = 0.2};
  const Projected computed = smooth(points, options).value();
  const Projected given = smooth(points, options, {normals}).value();
  EXPECT_EQ(count_different(computed.results, given.results), 0u);
}

// An algebraic sphere through points and normals of a sphere is that sphere, from anywhere near it.
TEST(MlsSurface, KeepsEachNormalWithItsPoint) {
  const World3 centre{1, 2, 3};
  Random random(21);
  std::vector<World3> points, queries;
  std::vector<Normal> normals;
  for (int i = 0; i < 3000; ++i) {
    const World3 outward = surface_point(Sphere{}, random.uniform(), random.uniform()).normal;
    points.push_back(centre + outward);
    normals.push_back(unit_normal(outward));
    if (i % 10 == 0) queries.push_back(centre + random.uniform(0.95, 1.05) * outward);
  }
  const MlsOptions options{.method = {.op = MlsOperator::kApss}, .h = 0.2};
  const MlsSurface surface = MlsSurface::create(points, options, {normals, true}).value();
  const Projected projected = surface.project(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const World3 from_centre = projected.positions[i] - centre;
    ASSERT_EQ(projected.results[i].status, Status::kOk);
    EXPECT_NEAR(dot(from_centre, from_centre), 1, 1e-6);
    EXPECT_NEAR(dot(from_centre, projected.results[i].normal), 1, 1e-6);  // outwards, as given
    EXPECT_NEAR(projected.results[i].mean_curvature, -1, 1e-5);
  }
}

TEST(MlsSurface, IsNotMadeOfPointsThatAreNotFinite) {
  std::vector<World3> points = small_square();
  points[3][2] = kNaN;
  const Result<Projected> smoothed = smooth(points);
  ASSERT_FALSE(smoothed);
  EXPECT_EQ(smoothed.error().fault, Fault::kBadInput);
}

TEST(Smooth, PutsMovedPointsAtTheirRoundedPlaceAndDisplacement) {
  const std::vector<World3> points = noisy_torus(0.1, 0.01);
  const Lattice lattice{{0.001, 0.001, 0.002}, {0.0001, 0, 0}};
  const Projected smoothed = smooth(points, {.h = 0.2, .lattice = lattice}).value();
  std::size_t moved_points = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const World3 rounded = to_world(lattice, to_index(lattice, points[i]));
    const bool moves = moved(smoothed.results[i].status);
    moved_points += moves ? 1 : 0;
    EXPECT_EQ(smoothed.positions[i],
              moves ? rounded + smoothed.results[i].displacement : points[i]);
  }
  EXPECT_GT(moved_points, points.size() / 2);
}

}  // namespace
}  // namespace pss::test
