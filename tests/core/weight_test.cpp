#include "core/weight.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pss::test {
namespace {

class TaperedGaussianTest : public testing::TestWithParam<double> {};

TEST_P(TaperedGaussianTest, IsAGaussianUntilTheTaperBegins) {
  const double radius = GetParam();
  const TaperedGaussian weight(radius);
  for (int i = 0; i <= 100; ++i) {
    const double rho = (radius - 0.5) * i / 100;
    const double expected = std::exp(-rho * rho);
    EXPECT_NEAR(weight.weight(rho * rho), expected, 1e-14 * expected);
  }
}

TEST_P(TaperedGaussianTest, IsZeroFromTheRadiusOnAndPositiveBefore) {
  const double r = GetParam();
  const TaperedGaussian weight(r);
  for (const double beyond : {r, r + 1e-9, r + 1, 1e6, 1e150}) {
    const TaperedGaussian::Value value = weight.with_derivatives(beyond * beyond);
    EXPECT_EQ(value.weight, 0);
    EXPECT_EQ(value.first, 0);
    EXPECT_EQ(value.second, 0);
  }
  EXPECT_GT(weight.weight((r - 1e-3) * (r - 1e-3)), 0);
}

TEST_P(TaperedGaussianTest, HasTheDerivativesOfItsDifferences) {
  const double r = GetParam();
  const TaperedGaussian weight(r);
  const double e = 1e-5;
  for (int i = 1; i < 400; ++i) {
    const double x = r * r * i / 400;
    const double scale = std::exp(-x);
    const TaperedGaussian::Value v = weight.with_derivatives(x);
    EXPECT_EQ(v.weight, weight.weight(x));
    EXPECT_NEAR(v.first, (weight.weight(x + e) - weight.weight(x - e)) / (2 * e), 1e-7 * scale);
    const double second =
        (weight.with_derivatives(x + e).first - weight.with_derivatives(x - e).first) / (2 * e);
    EXPECT_NEAR(v.second, second, 1e-3 * scale);  // its own slope jumps where the taper begins
  }
}

TEST_P(TaperedGaussianTest, IsTwiceContinuousWhereTheTaperBeginsAndEnds) {
  const double r = GetParam();
  const TaperedGaussian weight(r);
  for (const double border : {(r - 0.5) * (r - 0.5), r * r}) {
    const TaperedGaussian::Value before = weight.with_derivatives(border - 1e-9);
    const TaperedGaussian::Value after = weight.with_derivatives(border + 1e-9);
    const double scale = std::exp(-border);
    EXPECT_NEAR(before.weight, after.weight, 1e-7 * scale);
    EXPECT_NEAR(before.first, after.first, 1e-7 * scale);
    EXPECT_NEAR(before.second, after.second, 1e-6 * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(Radii, TaperedGaussianTest, testing::Values(1.0, 1.5, 3.0, 4.5, 12.0));

TEST(TaperedGaussian, DoesNotSeeRadiiBeyondWhereTheGaussianIsZero) {
  const TaperedGaussian far(1e300);
  const TaperedGaussian near(TaperedGaussian::kWidest);
  for (double x = 0; x < 2000; x += 0.7) EXPECT_EQ(far.weight(x), near.weight(x));
}

}  // namespace
}  // namespace pss::test
