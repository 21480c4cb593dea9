#include "stream/widths/noise.h"

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "tests/stream/synth_store.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_value;
using test::noise_of;
using test::Points;
using test::sample_of;
using test::store_of;
using test::synth_points;

void expect_equal(const Noise& found, const Noise& expected) {
  EXPECT_EQ(found.sample, expected.sample);
  EXPECT_EQ(found.sigma, expected.sigma);
  EXPECT_EQ(found.first, expected.first);
  EXPECT_EQ(found.apart, expected.apart);
  ASSERT_EQ(found.trials.size(), expected.trials.size());
  for (std::size_t k = 0; k < found.trials.size(); ++k) {
    EXPECT_EQ(found.trials[k].usable, expected.trials[k].usable);
    EXPECT_EQ(found.trials[k].residual, expected.trials[k].residual);
    EXPECT_EQ(found.trials[k].bend, expected.trials[k].bend);
    EXPECT_EQ(found.trials[k].change, expected.trials[k].change);
    EXPECT_EQ(found.trials[k].noise_change, expected.trials[k].noise_change);
  }
}

TEST(Noise, HasTheStandardDeviationThatWasPutIn) {
  test::TemporaryDirectory folder;
  for (const auto& [surface, sigma] : {std::pair<Surface, double>{Torus{}, 0.1},
                                       {Torus{}, 0.3},
                                       {Sphere{}, 0.1},
                                       {Terrain{}, 0.3}}) {
    const Noise noise = noise_of(store_of(synth_points(surface, 20000, sigma), folder / "s.pss"));

    // In measured spacings, which noise makes up to 2 % larger.
    EXPECT_NEAR(noise.sigma / sigma, 1, 0.06) << shape_name(surface) << " " << sigma;
    EXPECT_EQ(noise.first, 0);
  }
}

TEST(Noise, IsFoundByEveryDegreeAndWeight) {
  test::TemporaryDirectory folder;
  const Store store = store_of(synth_points(Torus{}, 40000, 0.2), folder / "s.pss");
  for (const auto& [weight, degree] : {std::pair{WeightKind::kGaussian, 1},
                                       {WeightKind::kGaussian, 4},
                                       {WeightKind::kWendland, 2}}) {
    const Noise noise = noise_of(store, {MlsOperator::kLevin, weight, {}, degree});

    EXPECT_NEAR(noise.sigma, 0.2, 0.02) << name_of(weight) << degree;
  }
}

TEST(Noise, IsNextToNothingOnASmoothSurface) {
  test::TemporaryDirectory folder;
  for (const Surface& surface : {Surface{Torus{}}, Surface{Terrain{}}}) {
    const Noise noise = noise_of(store_of(synth_points(surface, 20000, 0), folder / "s.pss"));

    EXPECT_LT(noise.sigma, 0.002) << shape_name(surface);
    EXPECT_EQ(noise.apart, 0);
  }
}

TEST(Noise, ChangesProjectionsBetweenWidthsAsMuchAsPredicted) {
  test::TemporaryDirectory folder;
  const Noise noise = noise_of(store_of(synth_points(Plane{}, 20000, 0.3), folder / "s.pss"));

  for (std::size_t k = 0; k + 1 < noise.trials.size(); ++k)
    EXPECT_NEAR(noise.trials[k].change / (noise.sigma * noise.trials[k].noise_change), 1, 0.1);
}

TEST(Noise, OfASpacingOrMoreIsSeenByAWiderFit) {
  test::TemporaryDirectory folder;
  const Noise noise = noise_of(store_of(synth_points(Plane{}, 40000, 1), folder / "s.pss"));

  const Spacing spacing =
      *sample_of(store_of(synth_points(Plane{}, 40000, 1), folder / "t.pss")).spacing;
  const double sigma = 0.5 / spacing.spacing;  // one spacing of the plane, which noise enlarges
  EXPECT_GT(noise.first, 0);
  EXPECT_NEAR(noise.sigma / sigma, 1, 0.15);
}

TEST(Noise, IsNotSeenInAVolume) {
  test::TemporaryDirectory folder;
  test::Random random(3);
  const Points cube{{{0.01, 0.01, 0.01}, {0, 0, 0}}, test::random_cube(random, 6000, 3000)};

  EXPECT_EQ(noise_of(store_of(cube, folder / "s.pss")).first, -1);
}

TEST(Noise, IsUnknownWhereThereAreFewPoints) {
  test::TemporaryDirectory folder;
  test::Random random(4);
  const Points few{{{1, 1, 1}, {0, 0, 0}}, test::random_cube(random, 20, 1000)};
  const Noise noise = noise_of(store_of(few, folder / "s.pss"));

  EXPECT_EQ(noise.sample, 20u);
  EXPECT_EQ(noise.first, -1);
}

/// Two unit grids over each other, with noise along z.
Points two_sheets(double apart, double noise) {
  test::Random random(5);
  const Lattice lattice{{0.001, 0.001, 0.001}, {0, 0, 0}};
  std::vector<World3> world;
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y)
      for (const double z : {0.0, apart})
        world.push_back({x + random.uniform(-0.2, 0.2), y + random.uniform(-0.2, 0.2),
                         z + noise * random.normal()});
  return {lattice, test::on_lattice_sorted(lattice, world)};
}

TEST(Noise, SeesTheOtherSheetAtItsDistance) {
  test::TemporaryDirectory folder;
  for (const double sigma : {0.0, 0.3})
    for (const double apart : {3.0, 6.0}) {
      const Store store = store_of(two_sheets(apart, sigma), folder / "s.pss");
      const double spacing = sample_of(store).spacing->spacing;

      // The nearer part of a noisy sheet, and a tenth of the sample that sees it nearest.
      EXPECT_NEAR(noise_of(store).apart * spacing, apart - 2 * sigma, 0.1 + sigma) << apart;
    }
}

TEST(Noise, IsTheSameWhateverTheTilesTheMemoryTheThreadsAndTheOrderOfRows) {
  test::TemporaryDirectory folder;
  Points points = synth_points(Torus{}, 30000, 0.2);
  const Store whole = store_of(points, folder / "whole.pss");
  const Noise expected = noise_of(whole);

  expect_equal(noise_of(store_of(points, folder / "tiles.pss", 777)), expected);
  MemoryBudget least(minimum_limit(1), 1);
  Monitor monitor;
  expect_equal(expect_value(measure_noise(whole, sample_of(whole), Method{}, least, monitor)),
               expected);
  {
    const ThreadLimit one(1);
    expect_equal(noise_of(whole), expected);
  }
  test::Random random(6);
  for (std::size_t i = points.positions.size(); i-- > 1;)
    std::swap(points.positions[i],
              points.positions[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
  expect_equal(noise_of(store_of(points, folder / "shuffled.pss", 5000)), expected);
}

}  // namespace
}  // namespace pss
