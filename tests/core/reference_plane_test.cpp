#include "core/reference_plane.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/scan.h"

namespace pss::test {
namespace {

// With a wrong element in its Jacobian, Newton's method would still arrive, but slowly.
TEST(ReferencePlane, IsReachedInFewPassesFromAnywhereNearANoisySurface) {
  const double s = 0.04;
  const double h = 3 * s;
  const Scan scan = scan_of(Torus{1, 0.4}, s, 0.2 * s);
  const CellGrid grid(scan.lattice, scan.points, 3.5 * h);
  Random random(31);
  Offsets offsets;
  int passes = 0;
  int count = 0;
  for (std::size_t i = 0; i < scan.points.size(); i += 20) {
    Query query{scan.points[i]};
    for (double& c : query.remainder) c = 0.15 * h * random.uniform(-1, 1);
    grid.gather(query, 3.5 * h, offsets);
    const ReferencePlane plane = find_reference_plane({offsets, 1 / h, TaperedGaussian(3)});
    ASSERT_EQ(plane.status, Status::kOk);
    EXPECT_LE(plane.passes, 5);
    passes += plane.passes;
    ++count;
  }
  EXPECT_LT(passes, 3.5 * count);
}

TEST(ReferencePlane, HoldsBothConditions) {
  const double s = 0.05;
  const double h = 2 * s;
  const Scan scan = scan_of(Torus{1, 0.4}, s, 0.2 * s);
  const CellGrid grid(scan.lattice, scan.points, 3.5 * h);
  const TaperedGaussian weight(3);
  Offsets near;
  for (std::size_t i = 0; i < scan.points.size(); i += 50) {
    grid.gather({scan.points[i]}, 3.5 * h, near);
    const ReferencePlane plane = find_reference_plane({near, 1 / h, weight});
    ASSERT_EQ(plane.status, Status::kOk);
    World3 turning{0, 0, 0};
    double sliding = 0;
    for (std::size_t k = 0; k < near.size(); ++k) {
      const World3 p = 1 / h * World3{near.x[k], near.y[k], near.z[k]} - plane.t * plane.normal;
      const double d = dot(plane.normal, p);
      const TaperedGaussian::Value w = weight.with_derivatives(dot(p, p));
      turning = turning + w.weight * d * (p - d * plane.normal);
      sliding += d * (w.weight + d * d * w.first);
    }
    EXPECT_LT(std::sqrt(dot(turning, turning)), 1e-13);
    EXPECT_LT(std::abs(sliding), 1e-13);
    EXPECT_TRUE(is_canonical(plane.normal));
  }
}

}  // namespace
}  // namespace pss::test
