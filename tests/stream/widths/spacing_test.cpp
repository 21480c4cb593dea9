#include "stream/widths/spacing.h"

#include <gtest/gtest.h>

#include <set>

#include "stream/widths/nearest.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/cloud.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::Cloud;
using test::expect_ok;
using test::expect_value;

const Lattice kLattice{{0.01, 0.02, 0.01}, {0, 0, 0}};

Store store_of(std::vector<Index3> points, const std::string& path, std::size_t tile) {
  test::sort_by_key(points);
  const Cloud cloud{points, {}};
  StoreHeader header;
  header.lattice = kLattice;
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  for (std::size_t begin = 0; begin < points.size(); begin += tile)
    expect_ok(test::append_tile(writer, header.schema, cloud, begin,
                                std::min(begin + tile, points.size())));
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

/// By the definition: sort all distinct positions by distance, then by place.
std::vector<Neighbour> brute_force(const std::vector<Index3>& points, const Index3& query,
                                   std::size_t k) {
  std::set<Neighbour> sorted;
  for (const Index3& p : points)
    if (p != query) sorted.insert({distance_sq(kLattice, query, p), p});
  return {sorted.begin(), std::next(sorted.begin(), static_cast<std::ptrdiff_t>(k))};
}

std::vector<Index3> some_points(std::size_t count, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<Index3> points = test::random_cube(random, count, 3000);
  for (std::size_t i = 0; i < count / 4; ++i) points.push_back(points[i]);  // duplicates
  return points;
}

TEST(NearestSearch, FindsTheNearestDistinctPositionsOfTheWholeStore) {
  test::TemporaryDirectory folder;
  const std::vector<Index3> points = some_points(3000, 5);
  const Store store = store_of(points, folder / "s.pss", 400);
  MemoryBudget budget(512u << 20, 1);
  const Source source(store);
  NearestSearch search(source, budget);

  for (std::size_t i = 0; i < points.size(); i += 101)
    for (const std::size_t k : {1u, 16u, 300u})
      EXPECT_EQ(expect_value(search.nearest(points[i], k)), brute_force(points, points[i], k));
}

TEST(NearestSearch, FindsAllWhereThereAreFewer) {
  test::TemporaryDirectory folder;
  const Store store = store_of({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, folder / "s.pss", 2);
  MemoryBudget budget(512u << 20, 1);
  const Source source(store);
  NearestSearch search(source, budget);

  EXPECT_EQ(expect_value(search.nearest({0, 0, 0}, 1)).size(), 1u);
  EXPECT_EQ(expect_value(search.nearest({0, 0, 0}, 2)).size(), 1u);
}

TEST(Spacing, IsTheMedianOverAllDistinctPositionsWhereThereAreFew) {
  test::TemporaryDirectory folder;
  const std::vector<Index3> points = some_points(1001, 6);
  std::vector<double> distances;
  for (const Index3& p : std::set<Index3>(points.begin(), points.end()))
    distances.push_back(std::sqrt(brute_force(points, p, 16).back().first));
  std::ranges::sort(distances);
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;

  const Spacing spacing =
      *expect_value(measure_spacing(store_of(points, folder / "s.pss", 300), budget, monitor));

  EXPECT_EQ(spacing.sample, distances.size());
  EXPECT_EQ(spacing.d16, distances[(distances.size() - 1) / 2]);
  EXPECT_DOUBLE_EQ(spacing.spacing, spacing.d16 * std::sqrt(std::acos(-1.0) / 16));
}

TEST(Spacing, DoesNotDependOnTheTiling) {
  test::TemporaryDirectory folder;
  const std::vector<Index3> points = some_points(30000, 7);
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;

  const Spacing one =
      *expect_value(measure_spacing(store_of(points, folder / "a.pss", 100000), budget, monitor));
  const Spacing many =
      *expect_value(measure_spacing(store_of(points, folder / "b.pss", 777), budget, monitor));

  EXPECT_EQ(one.sample, kSpacingSample);
  EXPECT_EQ(one.d16, many.d16);
  EXPECT_EQ(one.d16_low, many.d16_low);
  EXPECT_EQ(one.d16_high, many.d16_high);
}

TEST(Spacing, OfAGridIsTheGridStep) {
  test::TemporaryDirectory folder;
  std::vector<Index3> points;
  for (std::int64_t x = 0; x < 120; ++x)
    for (std::int64_t y = 0; y < 120; ++y) points.push_back({x * 100, y * 50, 0});  // 1 x 1
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;

  const Spacing spacing =
      *expect_value(measure_spacing(store_of(points, folder / "s.pss", 5000), budget, monitor));

  // The 16th nearest of a unit grid lies at sqrt(5): 4 at 1, 4 at sqrt 2, 4 at 2, 8 at sqrt 5.
  EXPECT_DOUBLE_EQ(spacing.d16, std::sqrt(5.0));
  EXPECT_NEAR(spacing.spacing, 1, 0.01);
  EXPECT_FALSE(spacing.varying());
}

TEST(Spacing, IsEmptyBelowSeventeenDistinctPositions) {
  test::TemporaryDirectory folder;
  std::vector<Index3> points;
  for (std::int64_t i = 0; i < 16; ++i)
    for (int repeat = 0; repeat < 9; ++repeat) points.push_back({i, 0, 0});
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;

  EXPECT_FALSE(
      expect_value(measure_spacing(store_of(points, folder / "s.pss", 50), budget, monitor))
          .has_value());
}

}  // namespace
}  // namespace pss
