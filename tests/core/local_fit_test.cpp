#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/batches.h"
#include "tests/support/odd_clouds.h"

namespace pss::test {
namespace {

Support support_of(int degree) { return {1, radius_factor(degree)}; }

// Even heights over a grid that is its own mirror image: the plane is level, whatever the weights.
TEST(LocalFit, ReproducesAPolynomialOfItsDegree) {
  const auto height = [](double x, double y, int degree) {
    const double square = 0.1 + 0.04 * x * x - 0.05 * x * y + 0.06 * y * y;
    const double fourth = 0.0011 * x * x * y * y - 0.0009 * x * x * x * x + 0.0007 * x * x * x * y;
    return degree < 4 ? square : square + fourth;
  };
  for (int degree = 2; degree <= kMostDegree; ++degree) {
    const auto points = grid_on([&](double x, double y) { return height(x, y, degree); }, 0.25, 5);
    const Projection p = project_origin(points, support_of(degree), levin(degree));
    ASSERT_EQ(p.status, Status::kOk);
    EXPECT_NEAR(p.displacement[2], 0.1, 1e-10);
    EXPECT_NEAR(p.normal[2], 1, 1e-10);
    EXPECT_NEAR(p.mean_curvature, 0.04 + 0.06, 1e-9);
    EXPECT_NEAR(p.gaussian_curvature, 4 * 0.04 * 0.06 - 0.05 * 0.05, 1e-9);
    // The eigenvector of ((0.08, -0.05), (-0.05, 0.12)) to its larger eigenvalue.
    const World3 direction = normalized({-0.05, 0.02 + std::sqrt(0.0029), 0});
    EXPECT_NEAR(dot(p.principal_direction, direction), 1, 1e-9);
    EXPECT_LT(p.residual, 1e-7);
  }
}

TEST(LocalFit, ReproducesAMonkeySaddleOnAGridOfItsSymmetry) {
  Points points;  // a triangular grid: three turns bring both onto themselves
  for (int i = -40; i <= 40; ++i)
    for (int j = -40; j <= 40; ++j) {
      const double x = 0.2 * (i + 0.5 * j);
      const double y = 0.2 * std::sqrt(0.75) * j;
      points.push_back({x, y, 0.05 + 0.02 * (x * x * x - 3 * x * y * y)});
    }
  for (const int degree : {3, 4}) {
    const Projection p = project_origin(points, support_of(degree), levin(degree));
    ASSERT_EQ(p.status, Status::kOk);
    EXPECT_NEAR(p.displacement[2], 0.05, 1e-10);
    EXPECT_NEAR(p.normal[2], 1, 1e-10);
    EXPECT_NEAR(p.mean_curvature, 0, 1e-9);
    EXPECT_NEAR(p.gaussian_curvature, 0, 1e-9);
    EXPECT_LT(p.residual, 1e-7);
  }
}

TEST(LocalFit, ReportsTheWeightedRmsResidual) {
  // Each place twice, 0.02 above and below: the polynomial runs between.
  const Points points = joined(flat(0.02), flat(-0.02));
  for (int degree = 0; degree <= kMostDegree; ++degree)
    EXPECT_NEAR(project_origin(points, {1, 3}, levin(degree)).residual, 0.02, 1e-9);
}

/// The same, but for the status.
void expect_same_fit(Projection actual, const Projection& expected) {
  actual.status = expected.status;
  EXPECT_TRUE(same_bits(actual, expected));
}

/// Expects the result of `determined`, named as reduced where more was asked for.
void expect_degree(const Points& points, int asked, int determined) {
  const Projection p = project_origin(points, {1, 3}, levin(asked));
  const Projection lower = project_origin(points, {1, 3}, levin(determined));
  EXPECT_EQ(lower.status, Status::kOk);
  EXPECT_EQ(p.status, asked > determined ? Status::kDegreeReduced : Status::kOk);
  expect_same_fit(p, lower);
}

/// Parallel scan lines, 0.61 apart.
Points scan_lines(int lines) {
  Points points;
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  for (int line = 0; line < lines; ++line)
    for (int i = -200; i <= 200; ++i) {
      const double along = 0.0137 * i;
      const double across = 0.61 * line - 0.4;
      points.push_back(
          {c * along - s * across, s * along + c * across, 0.001 * ((7 * i + line) % 5)});
    }
  return points;
}

TEST(LocalFit, FallsToTheDegreeThatScanLinesDetermine) {
  for (int lines = 2; lines <= 6; ++lines)
    for (int asked = 1; asked <= kMostDegree; ++asked) {
      SCOPED_TRACE(std::to_string(lines) + " lines, degree " + std::to_string(asked));
      expect_degree(scan_lines(lines), asked, std::min(asked, lines - 1));
    }
}

TEST(LocalFit, FallsToTheDegreeThatFewPointsDetermine) {
  Random random(21);
  Points points;
  const int determined[] = {-1, -1, -1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 3, 4};
  for (int count = 0; count <= 15; ++count) {
    SCOPED_TRACE(count);
    if (count < 3)
      EXPECT_EQ(project_origin(points, {1, 3}, levin(4)).status, Status::kTooFew);
    else
      expect_degree(points, 4, determined[count]);
    points.push_back(
        {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-0.1, 0.1)});
  }
}

TEST(LocalFit, HasBoundaryValueZeroInsideAndOneOverRootPiOnAStraightEdge) {
  const Points inside = flat(0, 0.05, 6);
  Points edge;
  for (const World3& p : inside)
    if (p[1] > -0.01) edge.push_back({p[0], p[1] + 0.025, 0});
  for (int degree = 0; degree <= kMostDegree; ++degree) {
    EXPECT_NEAR(project_origin(inside, {1, 5}, levin(degree)).boundary, 0, 1e-8);
    EXPECT_NEAR(project_origin(edge, {1, 5}, levin(degree)).boundary,
                1 / std::sqrt(std::numbers::pi), 1e-3);
  }
}

}  // namespace
}  // namespace pss::test
