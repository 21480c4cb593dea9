#include "core/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/batches.h"
#include "tests/support/odd_clouds.h"
#include "tests/support/projection_comparison.h"

namespace pss::test {
namespace {

constexpr Support kSupport{1, 3};

TEST(Project, LeavesAPointOfAPlaneInPlaceWhicheverWayItFaces) {
  Random random(6);
  Points normals{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, normalized({1e-9, 0, 1})};
  for (int i = 0; i < 20; ++i)
    normals.push_back(normalized({random.normal(), random.normal(), random.normal()}));
  for (const World3& n : normals) {
    const OracleFrame<double> frame = OracleFrame<double>::of({n[0], n[1], n[2]});
    Points points;
    for (const World3& p : flat(0))
      points.push_back(to_world3<double>(p[0] * frame.u + p[1] * frame.v));
    for (int degree = 0; degree <= kMostDegree; ++degree) {
      const Projection p = project_origin(points, kSupport, levin(degree));
      EXPECT_EQ(p.status, Status::kOk);
      EXPECT_LT(length(p.displacement), 1e-10);
      EXPECT_NEAR(std::abs(dot(p.normal, n)), 1, 1e-10);
      EXPECT_TRUE(is_canonical(p.normal));
      EXPECT_NEAR(p.boundary, 0, 1e-9);
      EXPECT_NEAR(p.residual, 0, 1e-9);
    }
  }
}

TEST(Project, CountsTheNeighboursWithinTheRadiusOfTheFootPoint) {
  const Projection p = project_origin(flat(0.3, 0.25, 7.5), kSupport, levin(2));
  int expected = 0;
  for (int i = -30; i <= 30; ++i)
    for (int j = -30; j <= 30; ++j) expected += 0.0625 * (i * i + j * j) < 9;
  EXPECT_EQ(p.neighbours, static_cast<std::uint32_t>(expected));
}

TEST(Project, MergesSheetsNearerThanThreeQuartersOfTheWidthAndKeepsFarOnesApart) {
  const Projection near = project_origin(joined(flat(0), flat(0.5)), kSupport, levin(3));
  ASSERT_EQ(near.status, Status::kOk);
  EXPECT_NEAR(near.displacement[2], 0.25, 1e-12);
  const Projection far = project_origin(joined(flat(0), flat(2.4)), kSupport, levin(3));
  ASSERT_EQ(far.status, Status::kOk);
  EXPECT_LT(std::abs(far.displacement[2]), 0.1);
}

class ProjectionOfDegrees : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Each, ProjectionOfDegrees, testing::Values(0, 1, 2, 3, 4));

TEST_P(ProjectionOfDegrees, ProjectFromWithinHalfAWidthAndNotFromBeyond) {
  const int degree = GetParam();
  for (int i = -20; i <= 20; ++i) {
    const double height = 0.05 * i + 0.001;
    const Projection p = project_origin(flat(height, 0.2, 5), kSupport, levin(degree));
    const bool inside = std::abs(height) < 0.5;
    EXPECT_EQ(p.status, inside ? Status::kOk : Status::kOutOfDomain) << height;
    EXPECT_NEAR(p.displacement[2], inside ? height : 0, 1e-10);
  }
}

TEST_P(ProjectionOfDegrees, GiveTheSameResultAlongTheWholeNormalLine) {
  const int degree = GetParam();
  const double s = 0.04;
  const Scan scan = scan_of(Torus{1, 0.4}, s, 0.1 * s);
  const Support support{2 * s, radius_factor(degree) * 2 * s};
  ScanProjector project(scan, support, levin(degree));
  for (std::size_t i = 0; i < scan.points.size(); i += 100) {
    const Projection p = project({scan.points[i]});
    ASSERT_EQ(p.status, Status::kOk);
    const double length = std::sqrt(dot(p.displacement, p.displacement));
    if (length == 0) continue;
    const Query beyond{scan.points[i], p.displacement + 0.3 * support.h / length * p.displacement};
    const Projection back = project(beyond);
    ASSERT_EQ(back.status, Status::kOk);
    const World3 error = beyond.remainder + back.displacement - p.displacement;
    EXPECT_LT(std::sqrt(dot(error, error)), 1e-11 * s);
  }
}

TEST_P(ProjectionOfDegrees, ChangeNoBitWhenTheScanMovesByWholeCellsOrItsOriginIsFarAway) {
  const int degree = GetParam();
  const double s = 0.06;
  Scan scan = scan_of(Torus{1, 0.4}, s, 0.1 * s, 0x1p-20);
  for (Index3& p : scan.points)  // into one cell, of side 2^22: only then the order stays
    for (std::int64_t& c : p) c += 1 << 21;
  sort_by_key(scan.points);
  Scan moved_scan = scan;
  const Index3 by{std::int64_t{3} << 30, -(std::int64_t{5} << 25), std::int64_t{7} << 36};
  for (Index3& p : moved_scan.points)
    for (std::size_t a = 0; a < 3; ++a) p[a] += by[a];
  moved_scan.lattice.origin = {447000, 5411000, 1234.5};
  const Support support{2 * s, radius_factor(degree) * 2 * s};
  ScanProjector here(scan, support, levin(degree));
  ScanProjector there(moved_scan, support, levin(degree));
  for (std::size_t i = 0; i < scan.points.size(); i += 20)
    EXPECT_TRUE(same_bits(here({scan.points[i]}), there({moved_scan.points[i]})));
}

TEST_P(ProjectionOfDegrees, ChangeOnlyByRoundingWhenTheScanMovesAcrossCells) {
  const int degree = GetParam();
  const double s = 0.06;
  const Scan scan = scan_of(Torus{1, 0.4}, s, 0.1 * s, 0x1p-20);
  Scan moved_scan = scan;
  const auto move = [](const Index3& p) { return Index3{p[0] + 12345, p[1] - 7, p[2] + 999999}; };
  for (Index3& p : moved_scan.points) p = move(p);
  sort_by_key(moved_scan.points);
  const Support support{2 * s, radius_factor(degree) * 2 * s};
  ScanProjector here(scan, support, levin(degree));
  ScanProjector there(moved_scan, support, levin(degree));
  for (std::size_t i = 0; i < scan.points.size(); i += 20) {
    const World3 error =
        here({scan.points[i]}).displacement - there({move(scan.points[i])}).displacement;
    EXPECT_LT(std::sqrt(dot(error, error)), 1e-12 * s);
  }
}

}  // namespace
}  // namespace pss::test
