#include "core/polynomial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/cloud.h"

namespace pss::test {
namespace {

void add(Offsets& offsets, double x, double y, double z) {
  offsets.x.push_back(x);
  offsets.y.push_back(y);
  offsets.z.push_back(z);
}

LocalMap fit(const Offsets& offsets, int degree, double radius = 3, double t = 0) {
  return fit_local_map({offsets, 1, TaperedGaussian(radius)}, Frame{}, t, radius, degree);
}

/// Points spread over the disc, heights by `height`.
template <class Height>
Offsets disc(Height height) {
  Random random(8);
  Offsets offsets;
  for (int i = 0; i < 300; ++i) {
    const double x = random.uniform(-3, 3);
    const double y = random.uniform(-3, 3);
    add(offsets, x, y, height(x, y));
  }
  return offsets;
}

TEST(LocalMap, ReproducesAPolynomialOfItsDegree) {
  const auto height = [](double x, double y) {
    return 0.1 - 0.2 * x + 0.3 * y + 0.04 * x * x - 0.05 * x * y + 0.06 * y * y +
           0.007 * x * x * x + 0.008 * x * y * y - 0.0009 * x * x * x * x + 0.0011 * x * x * y * y;
  };
  const LocalMap map = fit(disc(height), 4);
  EXPECT_EQ(map.degree, 4);
  EXPECT_NEAR(map.coefficient(0, 0), 0.1, 1e-13);
  EXPECT_NEAR(map.coefficient(1, 0), -0.2, 1e-13);
  EXPECT_NEAR(map.coefficient(0, 1), 0.3, 1e-13);
  EXPECT_NEAR(map.coefficient(2, 0), 0.04, 1e-13);
  EXPECT_NEAR(map.coefficient(1, 1), -0.05, 1e-13);
  EXPECT_NEAR(map.coefficient(0, 2), 0.06, 1e-13);
  EXPECT_NEAR(map.coefficient(1, 2), 0.008, 1e-13);
  EXPECT_NEAR(map.coefficient(4, 0), -0.0009, 1e-13);
  EXPECT_NEAR(map.coefficient(2, 2), 0.0011, 1e-13);
  EXPECT_LT(map.residual, 1e-7);
}

TEST(LocalMap, MeasuresHeightsFromTheFootPoint) {
  const Offsets offsets = disc([](double, double) { return 0.4; });
  EXPECT_NEAR(fit(offsets, 2, 3, 0.25).coefficient(0, 0), 0.15, 1e-14);
}

TEST(LocalMap, ReportsTheWeightedRmsResidual) {
  // Each place twice, 0.02 above and below: the polynomial runs between.
  Offsets offsets = disc([](double, double) { return 0.02; });
  const Offsets below = disc([](double, double) { return -0.02; });
  offsets.x.insert(offsets.x.end(), below.x.begin(), below.x.end());
  offsets.y.insert(offsets.y.end(), below.y.begin(), below.y.end());
  offsets.z.insert(offsets.z.end(), below.z.begin(), below.z.end());
  for (int degree = 0; degree <= kMostDegree; ++degree)
    EXPECT_NEAR(fit(offsets, degree).residual, 0.02, 1e-9);
}

/// The degree that `lines` parallel scan lines determine, when more is asked for.
int degree_on_lines(int lines, int asked) {
  Offsets offsets;
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  for (int line = 0; line < lines; ++line)
    for (int i = -200; i <= 200; ++i) {
      const double along = 0.0137 * i;
      const double across = 0.61 * line - 0.4;
      add(offsets, c * along - s * across, s * along + c * across, 0.001 * ((7 * i + line) % 5));
    }
  return fit(offsets, asked).degree;
}

TEST(LocalMap, FallsToTheDegreeThatScanLinesDetermine) {
  for (int asked = 1; asked <= 4; ++asked)
    for (int lines = 1; lines <= 6; ++lines)
      EXPECT_EQ(degree_on_lines(lines, asked), std::min(asked, lines - 1))
          << lines << " lines, degree " << asked;
}

TEST(LocalMap, FallsToTheDegreeThatFewPointsDetermine) {
  Random random(21);
  Offsets offsets;
  const int expected[] = {-1, 0, 0, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 3, 4};
  for (int count = 0; count <= 15; ++count) {
    EXPECT_EQ(fit(offsets, 4).degree, expected[count]) << count;
    add(offsets, random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-0.1, 0.1));
  }
}

TEST(LocalMap, HasBoundaryValueZeroInsideAndOneOverRootPiOnAStraightEdge) {
  Offsets inside;
  Offsets edge;
  for (int i = -120; i <= 120; ++i)
    for (int j = -120; j <= 120; ++j) {
      add(inside, 0.05 * i, 0.05 * j, 0);
      if (j >= 0) add(edge, 0.05 * i, 0.05 * (j + 0.5), 0);
    }
  for (int degree = 0; degree <= kMostDegree; ++degree) {
    EXPECT_NEAR(fit(inside, degree, 5).boundary, 0, 1e-12);
    EXPECT_NEAR(fit(edge, degree, 5).boundary, 1 / std::sqrt(std::numbers::pi), 1e-3);
  }
}

}  // namespace
}  // namespace pss::test
