// Whether first and last returns of one place count once in the measured spacing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/sorted_cloud.h"
#include "stream/widths/widths.h"
#include "tests/stream/synth_store.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

const Lattice kLattice{{0.001, 0.002, 0.001}, {100, 200, 300}};

SpacingSample measured(const std::vector<Index3>& points, std::size_t tile = 100000) {
  const TemporaryDirectory folder;
  Points sorted{kLattice, points};
  sort_by_key(sorted.positions);
  return sample_of(store_of(sorted, folder / "s.pss", tile));
}

/// A wavy square of side x side points one apart, none nearer to another than 0.4.
std::vector<Index3> wave(int side, std::uint64_t seed) {
  Random random(seed);
  std::vector<World3> points;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      points.push_back({100 + x + random.uniform(-0.3, 0.3), 200 + y + random.uniform(-0.3, 0.3),
                        300 + 2 * std::sin(x / 9.0) + 0.1 * random.normal()});
  return on_lattice_sorted(kLattice, points);
}

/// The points and `others` more beside each, less than `apart` from it.
std::vector<Index3> with_twins(const std::vector<Index3>& points, int others, double apart,
                               std::uint64_t seed) {
  Random random(seed);
  std::vector<Index3> all = points;
  for (const Index3& p : points)
    for (int i = 0; i < others; ++i) {
      all.push_back(p);
      for (std::size_t a = 0; a < 3; ++a)  // within a cube whose half diagonal is `apart`
        all.back()[a] += std::llrint(random.uniform(-0.55, 0.55) * apart / kLattice.scale[a]);
    }
  return all;
}

/// By the definition: the first 256 distinct positions by distance, then by place.
std::vector<Neighbour> nearest(const std::vector<Index3>& points, const Index3& query) {
  std::set<Neighbour> sorted;
  for (const Index3& p : points)
    if (p != query) sorted.insert({distance_sq(kLattice, query, p), p});
  return {sorted.begin(), std::next(sorted.begin(), 256)};
}

/// By the definition: without those that lie near the query or near one that counts.
double distance_to_place(const std::vector<Neighbour>& nearest, const Index3& query, double apart) {
  std::vector<Index3> places{query};
  for (const Neighbour& n : nearest) {
    if (std::ranges::any_of(places, [&](const Index3& place) {
          return distance_sq(kLattice, place, n.second) < apart * apart;
        }))
      continue;
    places.push_back(n.second);
    if (places.size() == 17) return std::sqrt(n.first);
  }
  return std::sqrt(nearest.back().first);
}

/// What both measurements give by the definition.
struct Expected {
  std::map<Index3, double> first, anew;
};

Expected by_definition(const std::vector<Index3>& points) {
  Expected expected;
  std::map<Index3, std::vector<Neighbour>> around;
  std::vector<double> sorted;
  for (const Index3& p : points) {
    around[p] = nearest(points, p);
    expected.first[p] = std::sqrt(around[p][15].first);
  }
  for (const auto& [p, d16] : expected.first) sorted.push_back(d16);
  std::ranges::sort(sorted);
  const double usual = sorted[(sorted.size() - 1) / 2];
  for (const auto& [p, d16] : expected.first)
    expected.anew[p] = distance_to_place(around[p], p, 0.1 * spacing_of_d16(std::min(d16, usual)));
  return expected;
}

std::map<Index3, double> by_position(const SpacingSample& sample) {
  std::map<Index3, double> d16;
  for (const SampledPosition& p : sample.points) d16[p.position] = p.d16;
  return d16;
}

TEST(Twins, CountOnce) {
  const std::vector<Index3> points = wave(70, 31);
  const Spacing once = *measured(points).spacing;

  const Spacing twice = *measured(with_twins(points, 1, 0.02, 32)).spacing;

  EXPECT_NEAR(twice.spacing / once.spacing, 1, 0.02);
  EXPECT_NEAR(twice.d16_low / once.d16_low, 1, 0.02);
  EXPECT_NEAR(twice.d16_high / once.d16_high, 1, 0.02);
  EXPECT_EQ(once.twins, 1);
  EXPECT_NEAR(twice.twins, std::sqrt(2), 0.1) << "twice as many in the same disc";
}

TEST(Twins, OfHalfThePointsCountOnce) {
  const std::vector<Index3> points = wave(70, 33);
  const auto half = points.begin() + 2450;
  std::vector<Index3> some = with_twins({points.begin(), half}, 1, 0.02, 34);
  some.insert(some.end(), half, points.end());

  EXPECT_NEAR(measured(some).spacing->spacing / measured(points).spacing->spacing, 1, 0.02);
}

TEST(Twins, OfTenReturnsCountOnce) {
  const std::vector<Index3> points = wave(70, 35);

  const Spacing ten = *measured(with_twins(points, 9, 0.02, 36)).spacing;

  EXPECT_NEAR(ten.spacing / measured(points).spacing->spacing, 1, 0.03);
}

TEST(Twins, AreThoseOfTheDefinition) {
  // Near the limit: some are twins, some are not, and some are of others than of themselves.
  const std::vector<Index3> points = with_twins(wave(20, 37), 2, 0.12, 38);
  const Expected expected = by_definition(points);

  const std::map<Index3, double> found = by_position(measured(points));

  EXPECT_EQ(found, expected.anew);
  std::size_t changed = 0;
  for (const auto& [p, d16] : expected.anew) changed += d16 != expected.first.at(p);
  EXPECT_GT(changed, found.size() / 10);
}

TEST(Twins, BeyondThe256NearestAreNotLookedFor) {
  std::vector<Index3> points = wave(30, 39);
  for (std::int64_t i = 0; i < 400; ++i) points.push_back({15500 + i % 20, 7250 + i / 20, 0});
  const Expected expected = by_definition(points);
  std::size_t ends = 0;
  for (const auto& [p, d16] : expected.anew)
    ends += d16 == std::sqrt(nearest(points, p).back().first);

  EXPECT_EQ(by_position(measured(points)), expected.anew);
  EXPECT_GT(ends, 0u);
}

TEST(Twins, AreNotSeenInASurfaceThatHasNone) {
  const std::vector<Index3> points = wave(35, 40);

  EXPECT_EQ(by_position(measured(points)), by_definition(points).first);
}

TEST(Twins, AreNotSeenWherePointsAreDenserThanElsewhere) {
  std::vector<Index3> points;
  for (const Index3& p : wave(35, 41)) {
    points.push_back({10000000 + 60 * p[0], 60 * p[1], 60 * p[2]});
    if (p[0] < 14000) points.push_back(p);  // sixty times as dense, but not most of them
  }

  const SpacingSample found = measured(points);

  EXPECT_TRUE(found.spacing->varying());
  EXPECT_EQ(found.spacing->twins, 1);
  EXPECT_EQ(by_position(found), by_definition(points).first);
}

TEST(Twins, DependOnNeitherOrderNorTiles) {
  Points points{kLattice, with_twins(wave(90, 42), 1, 0.03, 43)};
  const TemporaryDirectory folder;
  const SpacingSample expected = sample_of(store_of(points, folder / "a.pss"));

  std::ranges::reverse(points.positions);
  const SpacingSample found = sample_of(store_of(points, folder / "b.pss", 333));

  EXPECT_EQ(found.spacing->spacing, expected.spacing->spacing);
  EXPECT_EQ(found.spacing->twins, expected.spacing->twins);
  EXPECT_EQ(found.spacing->sample, kSpacingSample);
  EXPECT_EQ(by_position(found), by_position(expected));
}

TEST(Twins, LeaveASpacingWhereThereAreFewerPlacesThanSixteen) {
  const std::vector<Index3> points = with_twins(wave(3, 44), 1, 0.02, 45);

  const SpacingSample found = measured(points);

  ASSERT_EQ(found.points.size(), 18u);
  for (const SampledPosition& p : found.points) {
    double farthest = 0;
    for (const Index3& other : points)
      farthest = std::max(farthest, distance_sq(kLattice, p.position, other));
    EXPECT_EQ(p.d16, std::sqrt(farthest));
  }
}

TEST(Twins, AreNoneWhereEveryDistanceIsTooSmallForItsSquare) {
  const Lattice tiny{{1e-200, 1e-200, 1e-200}, {0, 0, 0}};
  const TemporaryDirectory folder;
  Random random(46);

  const SpacingSample found =
      sample_of(store_of({tiny, random_cube(random, 100, 1000)}, folder / "s.pss"));

  EXPECT_EQ(found.spacing->spacing, 0);
  EXPECT_EQ(found.spacing->twins, 1);
}

/// Two waves side by side, one six times as wide as the other.
std::vector<Index3> two_waves() {
  std::vector<Index3> points = wave(50, 47);
  for (const Index3& p : wave(50, 48)) points.push_back({100000 + 6 * p[0], 6 * p[1], 6 * p[2]});
  return points;
}

TEST(Twins, MakeNoPointsOwnWidthNarrower) {
  const TemporaryDirectory folder;
  const auto widths_of = [&](std::vector<Index3> points) {
    sort_by_key(points);
    const Store store = store_of({kLattice, std::move(points)}, folder / "s.pss");
    MemoryBudget budget(512u << 20, 1);
    Monitor monitor;
    return expect_value(choose_widths(store, {}, Method{}, budget, monitor));
  };
  const ChosenWidths once = widths_of(two_waves());
  const ChosenWidths twice = widths_of(with_twins(two_waves(), 1, 0.02, 49));

  // Twice as many points are within the same radius, and the 16th of them is nearer by sqrt(2).
  ASSERT_EQ(twice.nearest, kSpacingRank);
  EXPECT_NEAR(twice.factor / once.factor, std::sqrt(2), 0.15);
  EXPECT_NEAR(twice.neighbours / once.neighbours, 2, 0.3);
}

TEST(SpacingOf, ACloudInMemoryIsThatOfAJob) {
  for (const std::vector<Index3>& points :
       {wave(33, 50), wave(80, 51), with_twins(wave(80, 52), 1, 0.03, 53)}) {
    std::vector<World3> world;
    for (const Index3& p : points) world.push_back(to_world(kLattice, p));

    const std::optional<double> found = spacing_of(sort_cloud(world, {}, kLattice).value());

    EXPECT_EQ(found, measured(points).spacing->spacing);
  }
}

}  // namespace
}  // namespace pss::test
