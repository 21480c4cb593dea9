#include <gtest/gtest.h>

#include <cmath>

#include "core/polynomial.h"
#include "core/projection.h"
#include "tests/support/levin_oracle.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

/// A degree, the width in spacings.
using Case = std::tuple<int, double>;

class ProjectionOracle : public testing::TestWithParam<Case> {};

TEST_P(ProjectionOracle, AgreesOnRandomNeighbourhoods) {
  const auto [degree, width] = GetParam();
  const double s = 0.06;
  const Scan scan = scan_of(Torus{1, 0.4}, s, 0.2 * s);
  const Support support{width * s, radius_factor(degree) * width * s};
  const CellGrid grid(scan.lattice, scan.points, reach(support));
  Random random(7);
  Offsets offsets;
  int compared = 0;
  for (std::size_t i = 0; i < scan.points.size(); i += scan.points.size() / 12) {
    Query query{scan.points[i]};  // a place of no point, up to 0.2 h off the samples
    for (double& c : query.remainder) c = 0.1 * support.h * random.uniform(-1, 1);
    grid.gather(query, reach(support), offsets);
    const Projection fast = project_levin(offsets, support, degree);
    const LevinOracle::Result slow = LevinOracle(offsets, support).project(degree);
    if (!slow.converged || fast.status != Status::kOk) continue;
    double side = 0;
    for (int a = 0; a < 3; ++a) {
      const auto k = static_cast<std::size_t>(a);
      EXPECT_NEAR(fast.displacement[k], double(slow.displacement(a)), 1e-12 * support.h);
      side += fast.normal[k] * double(slow.normal(a));
    }
    const double sign = side < 0 ? -1 : 1;
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(fast.normal[static_cast<std::size_t>(a)], sign * double(slow.normal(a)), 1e-11);
    EXPECT_NEAR(fast.mean_curvature * support.h, sign * double(slow.mean_curvature) * support.h,
                1e-10);
    EXPECT_NEAR(fast.gaussian_curvature * support.h * support.h,
                double(slow.gaussian_curvature) * support.h * support.h, 1e-10);
    EXPECT_NEAR(fast.residual, double(slow.residual), 1e-9 * support.h);
    EXPECT_NEAR(fast.boundary, double(slow.boundary), 1e-12);
    ++compared;
  }
  EXPECT_GE(compared, 11);
}

INSTANTIATE_TEST_SUITE_P(DegreesAndWidths, ProjectionOracle,
                         testing::Combine(testing::Values(0, 1, 2, 3, 4),
                                          testing::Values(1.5, 2.5)));

}  // namespace
}  // namespace pss::test
