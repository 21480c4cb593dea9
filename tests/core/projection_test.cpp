#include "core/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "tests/support/scan.h"

namespace pss::test {
namespace {

Offsets offsets_of(const std::vector<World3>& points) {
  Offsets offsets;
  for (const World3& p : points) {
    offsets.x.push_back(p[0]);
    offsets.y.push_back(p[1]);
    offsets.z.push_back(p[2]);
  }
  return offsets;
}

bool is_finite(const World3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// A square grid of points in z = height, about the origin.
std::vector<World3> sheet(double height, double spacing = 0.25, int half = 16) {
  std::vector<World3> points;
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j) points.push_back({spacing * i, spacing * j, height});
  return points;
}

std::vector<World3> joined(std::vector<World3> a, const std::vector<World3>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Neighbourhoods that are hardly or not at all a piece of a surface, by name.
std::map<std::string, std::vector<World3>> odd_neighbourhoods() {
  std::map<std::string, std::vector<World3>> odd;
  const std::vector<World3> few{
      {0, 0, 0}, {0.5, 0, 0}, {0, 0.7, 0.1}, {-0.4, -0.3, 0}, {0.2, -0.6, 0.2}};
  for (std::size_t n = 0; n <= few.size(); ++n)
    odd["first " + std::to_string(n)] = {few.begin(), few.begin() + static_cast<long>(n)};
  odd["identical"] = std::vector<World3>(50, {0, 0, 0});
  odd["identical elsewhere"] = std::vector<World3>(50, {0.3, 0.2, -0.1});
  odd["copies and one"] = joined(odd["identical"], {{0.4, 0, 0}});
  odd["copies and two"] = joined(std::vector<World3>(100000, {0, 0, 0}), {{0.4, 0, 0}, {0, 1, 0}});
  for (int i = -20; i <= 20; ++i) {
    const double a = 0.07 * i;
    odd["line"].push_back({a, 2 * a, -a});
    odd["two lines"].push_back({a, 0.3, 0.01 * (i % 3)});
    odd["two lines"].push_back({a, -0.4, 0});
    odd["skew lines"].push_back({a, 0, 0});
    odd["skew lines"].push_back({0, a, 0.5});
  }
  odd["plane"] = sheet(0);
  odd["plane and copies"] = joined(sheet(0), std::vector<World3>(100000, {0.25, 0, 0}));
  odd["sheets near"] = joined(sheet(0), sheet(0.5));
  odd["sheets apart"] = joined(sheet(0), sheet(1.2));
  odd["sheets far"] = joined(sheet(0), sheet(2.4));
  odd["octahedron"] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  odd["only beyond the radius"] = {{3.1, 0, 0}, {0, 3.1, 0}, {-3.1, 0.5, 0}, {0, -3.1, 0.4}};
  odd["hardly weighted"] = {{2.99, 0, 0}, {0, 2.98, 0.3}, {-2.99, 0.1, 0}, {0, -2.97, 0.4}};
  odd["not numbers"] = {{std::nan(""), 0, 0}, {0, std::nan(""), 0}, {1, INFINITY, 0}, {0, 0, 0}};
  Random random(12);
  for (int i = 0; i < 300; ++i) {
    const World3 v{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    odd["volume"].push_back(v);
    odd["shell"].push_back(1.2 * normalized(v));
    odd["thin rod"].push_back({v[0], 1e-9 * v[1], 1e-9 * v[2]});
  }
  return odd;
}

TEST(ProjectLevin, GivesEveryOddNeighbourhoodAStatusAndNoNaN) {
  for (const auto& [name, points] : odd_neighbourhoods())
    for (const double h : {1.0, 0.05, 1e-8, 1e-150, 3.0})
      for (const double factor : {1.0, 3.0, 40.0, 1e12})
        for (int degree = 0; degree <= 4; ++degree) {
          if (points.size() > 1000 && degree % 2 == 0) continue;
          const Projection p =
              project_point(offsets_of(points), {h, factor * h}, {.degree = degree});
          SCOPED_TRACE(name + ", degree " + std::to_string(degree));
          EXPECT_TRUE(is_finite(p.displacement));
          EXPECT_TRUE(is_finite(p.normal));
          EXPECT_TRUE(std::isfinite(p.mean_curvature) && std::isfinite(p.gaussian_curvature));
          EXPECT_TRUE(std::isfinite(p.residual) && std::isfinite(p.boundary));
          EXPECT_LE(std::sqrt(dot(p.displacement, p.displacement)), h);
          EXPECT_NEAR(dot(p.normal, p.normal), moved(p.status) ? 1 : 0, 1e-14);
          EXPECT_TRUE(moved(p.status) || p.displacement == (World3{0, 0, 0}));
        }
}

struct Expected {
  const char* name;
  Status status;
};

TEST(ProjectLevin, NamesWhyAPointStays) {
  auto odd = odd_neighbourhoods();
  for (const Expected& e : {Expected{"first 0", Status::kTooFew},
                            {"first 1", Status::kTooFew},
                            {"first 2", Status::kTooFew},
                            {"first 3", Status::kDegreeReduced},
                            {"first 5", Status::kDegreeReduced},
                            {"identical", Status::kDegenerate},
                            {"identical elsewhere", Status::kDegenerate},
                            {"copies and one", Status::kDegenerate},
                            {"copies and two", Status::kDegreeReduced},
                            {"line", Status::kDegenerate},
                            {"thin rod", Status::kDegenerate},
                            {"octahedron", Status::kDegenerate},
                            {"only beyond the radius", Status::kTooFew},
                            {"not numbers", Status::kTooFew},
                            {"two lines", Status::kDegreeReduced},
                            {"plane", Status::kOk},
                            {"plane and copies", Status::kOk}})
    EXPECT_EQ(project_point(offsets_of(odd[e.name]), {1, 3}, {.degree = 3}).status, e.status)
        << e.name;
}

TEST(ProjectLevin, LeavesAPointOfAPlaneInPlace) {
  for (int degree = 0; degree <= 4; ++degree) {
    const Projection p = project_point(offsets_of(sheet(0)), {1, 3}, {.degree = degree});
    EXPECT_EQ(p.status, Status::kOk);
    EXPECT_EQ(p.displacement, (World3{0, 0, 0}));
    EXPECT_EQ(p.normal, (World3{0, 0, 1}));
    EXPECT_NEAR(p.boundary, 0, 1e-15);
    EXPECT_EQ(p.residual, 0);
  }
}

TEST(ProjectLevin, CountsTheNeighboursWithinTheRadiusOfTheFootPoint) {
  const Projection p = project_point(offsets_of(sheet(0.3, 0.25, 30)), {1, 3}, {.degree = 2});
  int expected = 0;
  for (int i = -30; i <= 30; ++i)
    for (int j = -30; j <= 30; ++j) expected += 0.0625 * (i * i + j * j) < 9;
  EXPECT_EQ(p.neighbours, static_cast<std::uint32_t>(expected));
}

TEST(ProjectLevin, MergesSheetsNearerThanThreeQuartersOfTheWidthAndKeepsFarOnesApart) {
  const Projection near =
      project_point(offsets_of(joined(sheet(0), sheet(0.5))), {1, 3}, {.degree = 3});
  ASSERT_EQ(near.status, Status::kOk);
  EXPECT_NEAR(near.displacement[2], 0.25, 1e-12);
  const Projection far =
      project_point(offsets_of(joined(sheet(0), sheet(2.4))), {1, 3}, {.degree = 3});
  ASSERT_EQ(far.status, Status::kOk);
  EXPECT_LT(std::abs(far.displacement[2]), 0.1);
}

class ProjectionOfDegrees : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Each, ProjectionOfDegrees, testing::Values(0, 1, 2, 3, 4));

TEST_P(ProjectionOfDegrees, ProjectFromWithinHalfAWidthAndNotFromBeyond) {
  const int degree = GetParam();
  for (int i = -20; i <= 20; ++i) {
    const double height = 0.05 * i + 0.001;
    std::vector<World3> points = sheet(height, 0.2, 25);
    std::erase_if(points, [&](const World3& p) { return dot(p, p) >= 3.5 * 3.5; });
    const Projection p = project_point(offsets_of(points), {1, 3}, {.degree = degree});
    const bool inside = std::abs(height) < 0.5;
    EXPECT_EQ(p.status, inside ? Status::kOk : Status::kOutOfDomain) << height;
    EXPECT_NEAR(p.displacement[2], inside ? height : 0, 1e-12);
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

bool same_bits(const Projection& a, const Projection& b) {
  return a.status == b.status && a.neighbours == b.neighbours && a.displacement == b.displacement &&
         a.normal == b.normal && a.mean_curvature == b.mean_curvature &&
         a.gaussian_curvature == b.gaussian_curvature && a.residual == b.residual &&
         a.boundary == b.boundary;
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
