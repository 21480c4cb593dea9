#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/closed_forms.h"
#include "tests/support/methods.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

// Expected orders and constants: the asymptotics of weighted least squares on even samples, with a
// Gaussian's radius beyond which nothing matters (4.5 to 5 h).

constexpr MlsOperator kPlaneOperators[] = {MlsOperator::kLevin, MlsOperator::kFast};

Method in_double(MlsOperator op, WeightKind weight, int degree) {
  return {op, weight, Precision::kDouble, degree};
}

double order(double coarse, double fine, double halvings) {
  return std::log2(coarse / fine) / halvings;
}

TEST(Accuracy, GrowsOnATorusAtTheOrderOfTheDegree) {
  const Torus torus{1, 0.4};
  const Scan coarse_scan = scan_of(torus, 0.08);
  const Scan fine_scan = scan_of(torus, 0.01);
  for (const MlsOperator op : kPlaneOperators)
    for (int m = 1; m <= 4; ++m) {
      const Method method = in_double(op, WeightKind::kGaussian, m);
      SCOPED_TRACE(name_of(method));
      const Errors coarse = measure(coarse_scan, torus, {0.16, 0.72}, method, 400);
      const Errors fine = measure(fine_scan, torus, {0.02, 0.09}, method, 400);
      EXPECT_GE(fine.moved, 400u);
      EXPECT_GE(order(coarse.distance, fine.distance, 3), m + 1 - 0.15);
      EXPECT_GE(order(coarse.normal, fine.normal, 3), m - 0.15);
      EXPECT_GE(order(coarse.curvature, fine.curvature, 3), m - 1 - 0.15);  // 0 for m = 1
    }
}

TEST(Accuracy, GrowsOnATorusAtTheSecondOrderWhereNormalsAreGiven) {
  const Torus torus{1, 0.4};
  const Scan coarse_scan = scan_of(torus, 0.08);
  const Scan fine_scan = scan_of(torus, 0.01);
  for (const MlsOperator op : {MlsOperator::kApss, MlsOperator::kRimls}) {
    const Method method = in_double(op, WeightKind::kGaussian, 3);
    SCOPED_TRACE(name_of(method));
    const Errors coarse = measure(coarse_scan, torus, {0.16, 0.48}, method, 400);
    const Errors fine = measure(fine_scan, torus, {0.02, 0.06}, method, 400);
    EXPECT_GE(fine.moved, 400u);
    EXPECT_GE(order(coarse.distance, fine.distance, 3), 2 - 0.15);
    EXPECT_LT(coarse.normal, 0.05 * 0.16 / torus.minor);  // of how far normals turn within h
    EXPECT_LT(fine.normal, 0.05 * 0.02 / torus.minor);
  }
}

TEST(Accuracy, IsThatOfTheTableOnATorus) {
  const Torus torus{1, 0.4};
  const double s = 0.02;
  const Scan scan = scan_of(torus, s);
  const double distance[] = {0, 1.0e-3, 4.1e-6, 3.8e-6, 4.9e-8};
  const double normal[] = {0, 3.0e-3, 8.2e-4, 2.0e-5, 5.6e-6};
  const double curvature[] = {0, 2, 9.6e-3, 9.5e-3, 1.8e-4};
  for (int m = 1; m <= 4; ++m) {
    const Errors e = measure(scan, torus, {2 * s, 9 * s}, levin(m), 600);
    EXPECT_NEAR(e.distance, distance[m], 0.1 * distance[m]);
    EXPECT_LT(e.normal, 1.2 * normal[m]);
    EXPECT_LT(e.curvature, 1.1 * curvature[m]);
  }
}

/// A radius that a weight is used with, in units of h; a Gaussian's is one that does not matter.
double radius_of(WeightKind weight) { return weight == WeightKind::kGaussian ? 5 : 3; }

TEST(Accuracy, LeavesASphereByTheClosedForm) {
  const double h = 0.1;
  const Sphere sphere{1};
  const Scan scan = scan_of(sphere, h / 3);
  for (const MlsOperator op : kPlaneOperators)
    for (const WeightKind weight : kWeightKinds)
      for (int m = 0; m <= 4; ++m) {
        const Method method = in_double(op, weight, m);
        SCOPED_TRACE(name_of(method));
        const double radius = radius_of(weight);
        const ClosedForms closed(weight, radius, m);
        const Errors e = measure(scan, sphere, {h, radius * h}, method, 200);
        const double bias = h * closed.sphere_bias(1 / h);
        EXPECT_NEAR(e.mean_distance, bias, 0.05 * std::abs(bias));
        if (m < 2) continue;
        const double ratio = m == 4 ? 1 : closed.sphere_curvature_ratio(1 / h);
        EXPECT_NEAR(e.mean_curvature_ratio, ratio, 0.1 * h * h);
      }
}

TEST(ClosedForms, AreThoseOfTheGaussian) {
  const double bias[] = {-0.05, -0.05, 2.5e-4, 2.5e-4, -3.75e-6};  // h = 1, sphere of radius 10
  const double noise[] = {0.399, 0.399, 0.631, 0.631, 0.810};
  for (int m = 0; m <= 4; ++m) {
    const ClosedForms closed(WeightKind::kGaussian, 8, m);
    EXPECT_NEAR(closed.sphere_bias(10), bias[m], 1e-6 * std::abs(bias[m]));
    EXPECT_NEAR(closed.noise_constant(), noise[m], 5e-4);
    EXPECT_NEAR(closed.edge_boundary(), 1 / std::sqrt(std::numbers::pi), 1e-9);
  }
  EXPECT_NEAR(ClosedForms(WeightKind::kGaussian, 8, 3).sphere_curvature_ratio(10), 1.01, 1e-9);
}

TEST(Accuracy, OfApssIsExactOnSpheresAndPlanes) {
  const Sphere sphere{1};
  const double single = 1e-7;  // normals are given with that error
  for (const WeightKind weight : kWeightKinds) {
    const Method method = in_double(MlsOperator::kApss, weight, 3);
    const Errors ball = measure(scan_of(sphere, 0.1), sphere, {0.3, 0.9}, method, 200);
    EXPECT_LT(ball.distance, single);
    EXPECT_LT(ball.normal, 3 * single);
    EXPECT_NEAR(ball.mean_curvature_ratio, 1, 10 * single);
    const Plane plane{20, 20, 0.3, -0.5};
    const Errors flat = measure(scan_of(plane, 0.5, 0, 0x1p-36), plane, {1, 3}, method, 200);
    EXPECT_LT(flat.distance, single);
    EXPECT_LT(flat.normal, single);
    EXPECT_LT(flat.curvature, single);
  }
}

TEST(Accuracy, OfRimlsLeavesASphereByTheMeanOfItsTangentPlanes) {
  // Tangent planes at a distance r lie r^2 / (2 rho) above the sphere; normals that turn by
  // r / rho weigh exp(-(r / (0.75 rho))^2) less, 1 to 2 % of it.
  const double h = 0.1;
  const Sphere sphere{1};
  const Scan scan = scan_of(sphere, h / 3);
  for (const WeightKind weight : kWeightKinds) {
    const double radius = radius_of(weight);
    const Errors e =
        measure(scan, sphere, {h, radius * h}, in_double(MlsOperator::kRimls, weight, 3), 200);
    const double bias = h * h / 2 * ClosedForms(weight, radius, 1).mean(2);
    EXPECT_NEAR(e.mean_distance, bias, 0.05 * bias);
    EXPECT_NEAR(e.mean_curvature_ratio, 1, 0.05);
  }
}

TEST(Accuracy, LeavesTheShareOfTheNoiseThatTheTheoryGives) {
  const double h = 2;
  const double sigma = 0.05;
  const Scan scan = scan_of(Plane{160, 160, 0, 0}, 1, sigma, 0x1p-30);
  std::vector<Query> queries = some_queries(scan, 2400);
  std::erase_if(queries, [&](const Query& query) {
    const World3 at = to_world(scan.lattice, query.position);
    return std::abs(at[0]) > 68 || std::abs(at[1]) > 68;
  });
  for (const Method& method : all_methods()) {
    SCOPED_TRACE(name_of(method));
    const double radius = radius_of(method.weight);
    ScanProjector project(scan, {h, radius * h}, method);
    const std::vector<Projection> results = project(queries);
    double square = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double z = project.place(queries[i], results[i])[2];
      square += z * z;
    }
    // With the plane's own normals, apss and rimls take the mean of the heights, as degree 1 does.
    const int degree = needs_normals(method.op) ? 1 : method.degree;
    const double left = ClosedForms(method.weight, radius, degree).noise_constant() * sigma / h;
    EXPECT_NEAR(std::sqrt(square / static_cast<double>(queries.size())), left, 0.07 * left);
  }
}

TEST(Accuracy, OfTheBoundaryValueOnAnEdge) {
  const double s = 0.1;
  const Scan scan = scan_of(Plane{20, 20, 0, 0}, s, 0, 0x1p-30);
  const Query edge{to_index(scan.lattice, {10, 0, 0})};
  const Query inside{to_index(scan.lattice, {1, 2, 0})};
  for (const Method& method : all_methods({1})) {
    SCOPED_TRACE(name_of(method));
    const double radius = radius_of(method.weight);
    ScanProjector project(scan, {8 * s, 8 * s * radius}, method);
    const double expected = ClosedForms(method.weight, radius, 1).edge_boundary();
    EXPECT_NEAR(project(edge).boundary, expected, 0.01);
    EXPECT_LT(project(inside).boundary, 0.01);
  }
}

TEST(Accuracy, OfCurvatureHasTheSignOfItsNormal) {
  const Sphere sphere{1};
  const Scan scan = scan_of(sphere, 0.03);
  for (const Method& method : all_methods({3})) {
    SCOPED_TRACE(name_of(method));
    ScanProjector project(scan, {0.06, 0.18}, method);
    for (const Query& query : some_queries(scan, 100)) {
      const Projection p = project(query);
      const World3 outward = to_world(scan.lattice, query.position);
      const double side = dot(p.normal, outward) > 0 ? 1 : -1;
      EXPECT_TRUE(needs_normals(method.op) ? side == 1 : is_canonical(p.normal));
      EXPECT_NEAR(p.mean_curvature, -side, 0.01);
      EXPECT_NEAR(p.gaussian_curvature, 1, 0.02);
    }
  }
}

/// The unit tangents of a torus along its tube's circle and about its axis, at a place near it.
struct TorusTangents {
  World3 meridian, parallel;
};

TorusTangents tangents(const Torus& torus, const World3& p) {
  const double axis = std::sqrt(p[0] * p[0] + p[1] * p[1]);
  const World3 out = normalized({p[0], p[1], 0});
  const World3 from_tube = normalized({axis - torus.major, 0, p[2]});
  return {from_tube[0] * World3{0, 0, 1} - from_tube[2] * out, {-out[1], out[0], 0}};
}

TEST(Accuracy, OfThePrincipalDirectionOnATorus) {
  const Torus torus{1, 0.4};
  const Scan scan = scan_of(torus, 0.02);
  for (const MlsOperator op : {MlsOperator::kLevin, MlsOperator::kFast, MlsOperator::kRimls})
    for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
      const Method method{op, WeightKind::kGaussian, precision, 3};
      SCOPED_TRACE(name_of(method));
      ScanProjector project(scan, {0.06, 0.18}, method);
      for (const Query& query : some_queries(scan, 200)) {
        const Projection p = project(query);
        ASSERT_EQ(p.status, Status::kOk);
        const World3 at = to_world(scan.lattice, query.position);
        const TorusTangents t = tangents(torus, at);
        // Along the tube the surface bends by 1 / minor against the outward normal: more than
        // about the axis, everywhere on this torus.
        const bool outward = dot(p.normal, foot_of(torus, at).normal) > 0;
        EXPECT_GT(std::abs(dot(p.principal_direction, outward ? t.parallel : t.meridian)), 0.995);
        EXPECT_TRUE(is_canonical(p.principal_direction));
        if (op == MlsOperator::kRimls) continue;
        EXPECT_NEAR(dot(p.principal_direction, p.normal), 0, 1e-6);
        EXPECT_NEAR(dot(p.principal_direction, p.principal_direction), 1, 1e-6);
      }
    }
}

}  // namespace
}  // namespace pss::test
