// The spacing of points from a sample of them, before anything is sorted.
#include "core/world_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/spacing.h"

namespace pss {
namespace {

std::vector<World3> sphere(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<World3> points(count);
  for (World3& p : points) {
    for (double& v : p) v = normal(random);
    const double length = std::hypot(p[0], p[1], p[2]);
    for (double& v : p) v /= length;
  }
  return points;
}

WorldSample sample_of(const std::vector<World3>& points) {
  WorldSample sample;
  for (const World3& p : points) sample.add(p);
  return sample;
}

double metered(const std::vector<World3>& points) {
  SpacingMeter meter(sample_of(points));
  meter.add(points);
  return meter.spacing();
}

/// The distance to the 16th nearest other position, by sorting them all.
double d16(const std::vector<World3>& points, const World3& from) {
  std::vector<double> distances;
  for (const World3& p : points)
    if (p != from) distances.push_back(std::hypot(p[0] - from[0], p[1] - from[1], p[2] - from[2]));
  std::ranges::sort(distances);
  return distances[15];
}

TEST(WorldSample, TellsTheSpacingOfASurfaceOfAnySize) {
  for (const std::size_t count : {1000u, 4096u, 20000u, 300000u}) {
    const double expected = std::sqrt(4 * std::numbers::pi / static_cast<double>(count));

    const SampledSpacing found = sample_of(sphere(count, count)).spacing();

    EXPECT_NEAR(found.likely / expected, 1, 0.05) << count;
    EXPECT_LE(found.least, 1.05 * expected) << count;
  }
}

TEST(WorldSample, BoundsTheSpacingOfALineFromBelow) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> along(0, 1);
  std::vector<World3> points(200000);
  for (World3& p : points) p = {along(random), 0, 0};

  const double least = sample_of(points).spacing().least;

  EXPECT_NEAR(least / metered(points), 1, 0.1);
}

TEST(WorldSample, DependsOnTheSetOfPositionsAlone) {
  std::vector<World3> points = sphere(30000, 2);
  const WorldSample once = sample_of(points);
  points.insert(points.end(), points.begin(), points.begin() + 20000);
  std::shuffle(points.begin(), points.end(), std::mt19937_64(3));

  const WorldSample twice = sample_of(points);

  EXPECT_EQ(twice.first(WorldSample::kMost), once.first(WorldSample::kMost));
  EXPECT_EQ(twice.spacing().likely, once.spacing().likely);
  EXPECT_EQ(twice.distinct(), once.distinct());
}

TEST(WorldSample, CountsDistinctPositions) {
  // Four standard errors of the estimate above the sample's size.
  for (const std::size_t count : {1u, 4096u, 5000u, 400000u}) {
    const double tolerance = count <= WorldSample::kMost ? 0 : 0.063;
    EXPECT_NEAR(sample_of(sphere(count, 9)).distinct() / static_cast<double>(count), 1, tolerance);
  }
}

TEST(WorldSample, IsNotMovedByFarPoints) {
  std::vector<World3> points = sphere(20000, 4);
  for (int i = 0; i < 200; ++i) points.push_back({1e38 * i, -1e30, 3e38});

  const WorldSample sample = sample_of(points);

  EXPECT_NEAR(sample.spacing().likely, std::sqrt(4 * std::numbers::pi / 20000), 0.002);
  for (const double coordinate : sample.middle()) EXPECT_LT(std::abs(coordinate), 1);
}

TEST(WorldSample, AsksFewPositionsForFewerNeighbours) {
  // Two at a distance of 1, and one far away: two of three have their nearest at 1.
  const std::vector<World3> points{{0, 0, 0}, {1, 0, 0}, {0, 1e30, 0}};

  const WorldSample sample = sample_of(points);

  EXPECT_EQ(sample.rank(), 1);
  EXPECT_DOUBLE_EQ(sample.spacing().likely, std::sqrt(std::numbers::pi));
  EXPECT_EQ(sample_of({{1, 2, 3}, {1, 2, 3}}).spacing().likely, 0);
  EXPECT_EQ(sample_of({{0.0, 0, 0}, {-0.0, 0, 0}}).distinct(), 1);
}

TEST(SpacingMeter, MeasuresWhatBruteForceDoes) {
  const std::vector<World3> points = sphere(9000, 6);
  std::vector<double> distances;
  for (const World3& query : sample_of(points).first(SpacingMeter::kQueries))
    distances.push_back(d16(points, query));
  std::ranges::sort(distances);

  EXPECT_NEAR(metered(points), spacing_of_d16(distances[(distances.size() - 1) / 2]), 1e-15);
}

TEST(SpacingMeter, CountsCopiesOfAPositionOnce) {
  const std::vector<World3> points = sphere(6000, 7);
  SpacingMeter meter(sample_of(points));

  for (int copy = 0; copy < 20; ++copy) meter.add(points);

  EXPECT_EQ(meter.spacing(), metered(points));
}

}  // namespace
}  // namespace pss
