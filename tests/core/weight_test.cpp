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
  for (const double beyond : {r, r + 1e-9, r + 1, 1e6, 1e150})
    EXPECT_EQ(weight.weight(beyond * beyond), 0);
  EXPECT_GT(weight.weight((r - 1e-3) * (r - 1e-3)), 0);
}

INSTANTIATE_TEST_SUITE_P(Radii, TaperedGaussianTest, testing::Values(1.0, 1.5, 3.0, 4.5, 12.0));

TEST(TaperedGaussian, DoesNotSeeRadiiBeyondWhereTheGaussianIsZero) {
  const TaperedGaussian far(1e300);
  const TaperedGaussian near(TaperedGaussian::kWidest);
  for (double x = 0; x < 2000; x += 0.7) EXPECT_EQ(far.weight(x), near.weight(x));
}

}  // namespace
}  // namespace pss::test
