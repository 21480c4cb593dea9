#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/projection.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

// Expected orders and constants: the asymptotics of weighted least squares with a Gaussian of
// width h on even samples, with a radius beyond which nothing matters (4.5 to 5 h).

class AccuracyOfDegrees : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, AccuracyOfDegrees, testing::Values(1, 2, 3, 4));

double order(double coarse, double fine, double halvings) {
  return std::log2(coarse / fine) / halvings;
}

TEST_P(AccuracyOfDegrees, ConvergeOnATorusAtTheirOrder) {
  const int m = GetParam();
  const Torus torus{1, 0.4};
  const auto errors = [&](double s) {
    return measure(scan_of(torus, s), torus, {2 * s, 9 * s}, levin(m), 400);
  };
  const Errors coarse = errors(0.08);
  const Errors fine = errors(0.01);
  EXPECT_GE(fine.moved, 400u);
  EXPECT_GE(order(coarse.distance, fine.distance, 3), m + 1 - 0.15);
  EXPECT_GE(order(coarse.normal, fine.normal, 3), m - 0.15);
  EXPECT_GE(order(coarse.curvature, fine.curvature, 3), m - 1 - 0.15);  // 0 for m = 1
}

TEST_P(AccuracyOfDegrees, HaveTheErrorOfTheirTableOnATorus) {
  const int m = GetParam();
  const Torus torus{1, 0.4};
  const double s = 0.02;
  const Errors e = measure(scan_of(torus, s), torus, {2 * s, 9 * s}, levin(m), 600);
  const double distance[] = {0, 1.0e-3, 4.1e-6, 3.8e-6, 4.9e-8};
  const double normal[] = {0, 3.0e-3, 8.2e-4, 2.0e-5, 5.6e-6};
  const double curvature[] = {0, 2, 9.6e-3, 9.5e-3, 1.8e-4};
  EXPECT_NEAR(e.distance, distance[m], 0.1 * distance[m]);
  EXPECT_LT(e.normal, 1.2 * normal[m]);
  EXPECT_LT(e.curvature, 1.1 * curvature[m]);
}

TEST_P(AccuracyOfDegrees, LieOffASphereByTheClosedForm) {
  const int m = GetParam();
  const double h = 0.1;
  const Sphere sphere{1};
  const Errors e = measure(scan_of(sphere, h / 3), sphere, {h, 5 * h}, levin(m), 200);
  const double closed[] = {0, -h * h / 2, std::pow(h, 4) / 4, std::pow(h, 4) / 4,
                           -3 * std::pow(h, 6) / 8};
  EXPECT_NEAR(e.mean_distance, closed[m], 0.05 * std::abs(closed[m]));
  const double curvature[] = {0, 0, 1 + h * h, 1 + h * h, 1};
  EXPECT_NEAR(e.mean_curvature_ratio, curvature[m], 0.05 * h * h);
}

TEST_P(AccuracyOfDegrees, LeaveTheShareOfTheNoiseThatTheTheoryGives) {
  const int m = GetParam();
  const double h = 2;
  const double sigma = 0.05;
  const Scan scan = scan_of(Plane{160, 160, 0, 0}, 1, sigma, 0x1p-30);
  ScanProjector project(scan, {h, 5 * h}, levin(m));
  double square = 0;
  int count = 0;
  for (std::size_t i = 0; i < scan.points.size(); i += 11) {
    const Query query{scan.points[i]};
    const World3 at = to_world(scan.lattice, query.position);
    if (std::abs(at[0]) > 68 || std::abs(at[1]) > 68) continue;
    const double z = project.place(query, project(query))[2];
    square += z * z;
    ++count;
  }
  const double constant[] = {0, 0.399, 0.631, 0.631, 0.810};
  EXPECT_NEAR(std::sqrt(square / count), constant[m] * sigma / h, 0.07 * constant[m] * sigma / h);
}

TEST(Accuracy, OfCurvatureHasTheSignOfItsNormal) {
  const Sphere sphere{1};
  const Scan scan = scan_of(sphere, 0.03);
  const Support support{0.06, 0.27};
  ScanProjector project(scan, support, levin(3));
  for (std::size_t i = 0; i < scan.points.size(); i += 50) {
    const Projection p = project({scan.points[i]});
    const World3 outward = to_world(scan.lattice, scan.points[i]);
    const double side = dot(p.normal, outward) > 0 ? 1 : -1;
    EXPECT_TRUE(is_canonical(p.normal));
    EXPECT_NEAR(p.mean_curvature, -side, 0.01);
    EXPECT_NEAR(p.gaussian_curvature, 1, 0.02);
  }
}

TEST(Accuracy, OfTheBoundaryValueOnAnEdge) {
  const double s = 0.1;
  const Scan scan = scan_of(Plane{20, 20, 0, 0}, s, 0, 0x1p-30);
  const Support support{8 * s, 40 * s};
  ScanProjector project(scan, support, levin(1));
  const Projection edge = project({to_index(scan.lattice, {10, 0, 0})});
  const Projection inside = project({to_index(scan.lattice, {1, 2, 0})});
  EXPECT_NEAR(edge.boundary, 0.564, 0.01);
  EXPECT_LT(inside.boundary, 0.01);
}

}  // namespace
}  // namespace pss::test
