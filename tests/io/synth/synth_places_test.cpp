// Where the points of synthetic scans lie: on the surface, with their noise, as dense as asked.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

#include "tests/io/synth/synth_fixture.h"

namespace pss::test {
namespace {

/// For every point the distance to its nearest other one, found with a grid of cells.
std::vector<double> nearest_distances(const std::vector<World3>& points, double cell) {
  using Cell = std::tuple<int, int, int>;
  const auto cell_of_point = [&](const World3& p, int a) {
    return static_cast<int>(std::floor(p[static_cast<std::size_t>(a)] / cell));
  };
  std::map<Cell, std::vector<const World3*>> cells;
  for (const World3& p : points)
    cells[{cell_of_point(p, 0), cell_of_point(p, 1), cell_of_point(p, 2)}].push_back(&p);
  std::vector<double> nearest;
  for (const World3& p : points) {
    double least = 1e300;
    for (int k = 0; k < 27; ++k) {
      const auto near =
          cells.find({cell_of_point(p, 0) + k % 3 - 1, cell_of_point(p, 1) + k / 3 % 3 - 1,
                      cell_of_point(p, 2) + k / 9 - 1});
      if (near == cells.end()) continue;
      for (const World3* q : near->second)
        if (q != &p)
          least = std::min(least, std::hypot(p[0] - (*q)[0], p[1] - (*q)[1], p[2] - (*q)[2]));
    }
    nearest.push_back(least);
  }
  return nearest;
}

TEST(SynthPlaces, WithoutNoiseEveryPointIsOnTheSurfaceToTheRounding) {
  for (const Surface& surface :
       {Surface(Torus{}), Surface(Sphere{}), Surface(Plane{10, 20, 0.1, 0}), Surface(Terrain())}) {
    const SynthOptions options = options_for(surface, 5000);
    const double half_step = grid(options).scale[0] / 2;
    for (const World3& p : places(options))
      ASSERT_LE(std::abs(foot_of(surface, p).distance), std::sqrt(3) * half_step * 1.001);
  }
}

TEST(SynthPlaces, TheTruthIsTheSurfaceBelowEveryPoint) {
  const SynthOptions options = rich_options();
  auto reader = SynthReader::create(options);
  const Schema& schema = (*reader)->header().schema;
  PointBatch batch;
  ASSERT_TRUE((*reader)->read(3000, batch));
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const std::byte* row = &batch.rows[i * schema.row_size()];
    const auto value = [&](const char* name) { return read_value(*schema.dimension(name), row); };
    Lattice local = grid(options);
    local.origin = {0, 0, 0};
    const Foot foot = foot_of(options.surface, to_world(local, batch.index[i]));

    EXPECT_NEAR(value("TrueDistance"), foot.distance, local.scale[0]);
    EXPECT_NEAR(value("TrueX") - options.offset[0], foot.position[0], 2 * local.scale[0]);
    EXPECT_NEAR(value("TrueY") - options.offset[1], foot.position[1], 2 * local.scale[0]);
    EXPECT_NEAR(value("TrueZ") - options.offset[2], foot.position[2], 2 * local.scale[0]);
  }
}

TEST(SynthPlaces, TheNoiseIsNormalWithTheSigmaAskedFor) {
  SynthOptions options = options_for(Torus{}, 200'000);
  options.noise = 0.3;
  const double sigma = 0.3 * spacing(options);
  double sum = 0, squares = 0, fourths = 0, previous = 0, lagged = 0;
  int beyond_two = 0;
  for (const World3& p : places(options)) {
    const double z = foot_of(options.surface, p).distance / sigma;
    sum += z;
    squares += z * z;
    fourths += z * z * z * z;
    lagged += z * previous;
    previous = z;
    if (std::abs(z) > 2) ++beyond_two;
  }
  const double n = 200'000;

  // Five standard errors of each estimate.
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2 / n));
  EXPECT_NEAR(fourths / n, 3, 5 * std::sqrt(96 / n));
  EXPECT_NEAR(lagged / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(beyond_two / n, 0.0455, 5 * std::sqrt(0.0455 / n));
}

/// The golden lattice's shortest distance is sqrt(2 / sqrt(5)) = 0.946 under every stretching.
TEST(SynthPlaces, SpacesItsPointsEvenlyWithoutJitter) {
  for (const Surface& surface :
       {Surface(Torus{}), Surface(Sphere{}), Surface(Plane{10, 40, 0.1, 0}), Surface(Terrain())}) {
    SynthOptions options = options_for(surface, 40'000);
    options.jitter = 0;
    const double s = spacing(options);
    std::vector<double> nearest = nearest_distances(places(options), 1.2 * s);
    std::ranges::sort(nearest);

    EXPECT_GT(nearest[nearest.size() / 50], 0.8 * s) << shape_name(surface);
    EXPECT_LT(nearest.back(), 1.4 * s) << shape_name(surface);
  }
}

/// Two points of the lattice come nearer by at most twice the jitter: 0.946 - 0.5.
TEST(SynthPlaces, JitterKeepsPointsApart) {
  for (const Surface& surface : {Surface(Torus{}), Surface(Terrain())}) {
    const SynthOptions options = options_for(surface, 40'000);
    const double s = spacing(options);
    std::vector<double> nearest = nearest_distances(places(options), 1.2 * s);
    std::ranges::sort(nearest);

    EXPECT_GT(nearest[nearest.size() / 50], 0.44 * s) << shape_name(surface);
    EXPECT_LT(nearest[nearest.size() / 2], 0.9 * s) << shape_name(surface);
  }
}

TEST(SynthPlaces, MakesTheCornerAsMuchDenserAsAsked) {
  SynthOptions options = options_for(Plane{100, 100}, 50'000);
  options.corner_density = 10;
  int in_corner = 0;
  for (const World3& p : places(options)) in_corner += p[0] < -25 && p[1] < -25;

  // 10/16 of 25/16.
  EXPECT_NEAR(in_corner / 50'000.0, 10.0 / 25, 0.005);
}

TEST(SynthPlaces, ChangesTheDensitySmoothlyWhenAsked) {
  SynthOptions options = options_for(Plane{100, 100}, 200'000);
  options.density_gradient = 9;
  int dense = 0, sparse = 0;
  for (const World3& p : places(options)) {
    dense += std::abs(p[0]) > 48 && std::abs(p[1]) > 48;
    sparse += std::abs(p[0]) < 2 && std::abs(p[1]) < 2;
  }

  EXPECT_NEAR(static_cast<double>(dense) / sparse, 9, 0.7);
}

TEST(SynthPlaces, CoversEveryPlaceByTwoOfThreeScans) {
  SynthOptions options = options_for(Plane{100, 100}, 30'000);
  options.scans = 3;
  const PointBatch batch = read_all(options);
  const double step = grid(options).scale[0];
  for (std::uint64_t scan = 0; scan < 3; ++scan) {
    double low = 1e300, high = -1e300;
    for (std::size_t i = scan * 10'000; i < (scan + 1) * 10'000; ++i) {
      low = std::min(low, step * static_cast<double>(batch.index[i][0]));
      high = std::max(high, step * static_cast<double>(batch.index[i][0]));
    }
    EXPECT_NEAR(low, -50 + 12.5 * static_cast<double>(scan), 0.3);
    EXPECT_NEAR(high, 25 + 12.5 * static_cast<double>(scan), 0.3);
  }
}

}  // namespace
}  // namespace pss::test
