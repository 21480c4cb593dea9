#include "core/mls_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/sorted_cloud.h"
#include "tests/core/mls_fixture.h"

namespace pss::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(MlsOptions, ChoosesTwiceTheSpacingWhereNothingIsSaid) {
  const std::vector<World3> points = noisy_torus(0.05, 0);
  const double spacing = spacing_of(sort_cloud(points).value()).value();
  EXPECT_NEAR(spacing, 0.05, 0.005);
  const MlsSurface surface = surface_over(points);
  EXPECT_EQ(surface.support().h, 2 * spacing);
  EXPECT_EQ(surface.support().radius, 6 * spacing);
  EXPECT_EQ(surface.size(), points.size());
}

TEST(MlsOptions, MakesHAndRadiusFollowFromEachOther) {
  const auto support = [](const MlsOptions& options) {
    return surface_over(small_square(), options).support();
  };
  EXPECT_EQ(support({.h = 0.5}).radius, 1.5);
  EXPECT_EQ(support({.method = {.degree = 4}, .h = 0.5}).radius, 2);
  EXPECT_EQ(support({.radius = 1.5}).h, 0.5);
  EXPECT_EQ(support({.method = {.weight = WeightKind::kPcl}, .radius = 1.5}).h, 1.5);
  EXPECT_EQ(support({.method = {.weight = WeightKind::kPcl}, .h = 1.5}).radius, 1.5);
  EXPECT_EQ(support({.h = 0.5, .radius = 0.75}).radius, 0.75);
}

class SenselessOptions : public testing::TestWithParam<MlsOptions> {};
INSTANTIATE_TEST_SUITE_P(MlsOptions, SenselessOptions,
                         testing::Values(MlsOptions{.h = -1}, MlsOptions{.h = kNaN},
                                         MlsOptions{.radius = HUGE_VAL},
                                         MlsOptions{.h = 2, .radius = 1}, MlsOptions{.knn = -1},
                                         MlsOptions{.knn = 10001}, MlsOptions{.h = 1, .knn = 5},
                                         MlsOptions{.method = {.degree = 5}},
                                         MlsOptions{.method = {.degree = -1}},
                                         MlsOptions{.lattice = Lattice{{0, 1, 1}, {0, 0, 0}}},
                                         MlsOptions{.lattice = Lattice{{1, 1, 1}, {0, kNaN, 0}}}));

TEST_P(SenselessOptions, AreAUsageError) {
  const Result<MlsSurface> surface = MlsSurface::create(small_square(), GetParam());
  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().fault, Fault::kUsage);
}

}  // namespace
}  // namespace pss::test
