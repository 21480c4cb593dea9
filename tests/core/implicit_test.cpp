#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/core/implicit_fixture.h"
#include "tests/support/batches.h"

namespace pss::test {
namespace {

/// A noisy torus with single outliers 2 spacings off and a normal missing here and there.
Scan rough_torus() {
  Scan scan = scan_of(Torus{1, 0.4}, 0.06, 0.2 * 0.06);
  for (std::size_t i = 0; i < scan.points.size(); i += 97)
    scan.points[i][2] += std::llrint(2 * scan.spacing / scan.lattice.scale[2]);
  for (std::size_t i = 5; i < scan.points.size(); i += 61) scan.normals[i] = {0, 0, 0};
  std::vector<std::pair<Index3, Normal>> both;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    both.push_back({scan.points[i], scan.normals[i]});
  std::ranges::sort(both, {}, [](const auto& p) { return encode_key(p.first); });
  for (std::size_t i = 0; i < both.size(); ++i) std::tie(scan.points[i], scan.normals[i]) = both[i];
  return scan;
}

void turn_every_third(Scan& scan) {
  for (std::size_t i = 0; i < scan.normals.size(); i += 3)
    for (float& c : scan.normals[i]) c = -c;
}

TEST(Apss, PutsPointsOntoTheSphereThatTheyLieOn) {
  const Scan scan = scan_of(Sphere{1}, 0.1);
  for (const WeightKind weight : kWeightKinds) {
    const Method method = implicit(MlsOperator::kApss, Precision::kDouble, weight);
    std::vector<Query> queries = some_queries(scan, 200);
    for (Query& q : queries) q.remainder = {0.02, -0.01, 0.03};
    const auto results = project_all(scan, {0.2, 0.6}, method, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Projection& p = results[i];
      const World3 at =
          to_world(scan.lattice, queries[i].position) + queries[i].remainder + p.displacement;
      ASSERT_EQ(p.status, Status::kOk);
      // Normals are stored in single precision: 6e-8, of which the mean over neighbours is left.
      EXPECT_NEAR(size(at), 1, 3e-9);
      EXPECT_LT(size(p.normal - at), 1e-7);
      EXPECT_NEAR(p.mean_curvature, -1, 2e-7);
      EXPECT_NEAR(p.gaussian_curvature, 1, 4e-7);
      EXPECT_EQ(p.principal_direction, (World3{0, 0, 0}));
    }
  }
}

TEST(ImplicitOperators, PutPointsOntoThePlaneThatTheyLieOn) {
  for (const MlsOperator op : kImplicit)
    for (const WeightKind weight : kWeightKinds) {
      const Projection p = project_origin(sheet(0.25), implicit(op, Precision::kDouble, weight));
      EXPECT_EQ(p.status, Status::kOk);
      EXPECT_NEAR(p.displacement[0], 0, 1e-12);
      EXPECT_NEAR(p.displacement[1], 0, 1e-12);
      EXPECT_NEAR(p.displacement[2], 0.25, 1e-12);
      EXPECT_LT(size(p.normal - World3{0, 0, 1}), 1e-12);
      EXPECT_NEAR(p.mean_curvature, 0, 1e-10);
      EXPECT_NEAR(p.gaussian_curvature, 0, 1e-10);
      EXPECT_NEAR(p.residual, 0, 1e-8);
      EXPECT_NEAR(p.boundary, 0, 1e-10);
    }
}

TEST(ImplicitOperators, KeepTheSideOfOrientedNormals) {
  for (const MlsOperator op : kImplicit) {
    const Scan scan = scan_of(Torus{1, 0.4}, 0.05);
    const auto queries = some_queries(scan, 100);
    const auto oriented = project_all(scan, {0.1, 0.3}, implicit(op), queries);
    const auto unknown = project_all(scan, {0.1, 0.3}, implicit(op), queries, false);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const World3 at = to_world(scan.lattice, queries[i].position);
      const Foot foot = foot_of(Torus{1, 0.4}, at);
      const double side = is_canonical(oriented[i].normal) ? 1 : -1;
      EXPECT_GT(dot(oriented[i].normal, foot.normal), 0.99);
      EXPECT_NEAR(oriented[i].mean_curvature, foot.mean_curvature, 0.1);
      EXPECT_TRUE(is_canonical(unknown[i].normal));
      EXPECT_LT(size(unknown[i].normal - side * oriented[i].normal), 1e-12);
      EXPECT_NEAR(unknown[i].mean_curvature, side * oriented[i].mean_curvature, 1e-9);
    }
  }
}

TEST(ImplicitOperators, DoNotCareOnWhichSideUnorientedNormalsStand) {
  for (const Precision precision : {Precision::kDouble, Precision::kSingle})
    for (const MlsOperator op : kImplicit) {
      Scan scan = scan_of(Torus{1, 0.4}, 0.06, 0.012);
      const auto queries = some_queries(scan, 500);
      const auto before = project_all(scan, {0.12, 0.36}, implicit(op, precision), queries, false);
      turn_every_third(scan);
      const auto after = project_all(scan, {0.12, 0.36}, implicit(op, precision), queries, false);
      EXPECT_EQ(count_different(before, after), 0u);
    }
}

TEST(ImplicitOperators, GiveInSinglePrecisionWhatDoubleGives) {
  Scan scan = rough_torus();
  const auto queries = some_queries(scan, 4000);
  for (const bool oriented : {true, false})
    for (const MlsOperator op : kImplicit)
      for (const WeightKind weight : kWeightKinds) {
        SCOPED_TRACE(std::string(name_of(op)) + " " + name_of(weight));
        const Support support{0.12, 0.36};
        const auto exact =
            project_all(scan, support, implicit(op, Precision::kDouble, weight), queries, oriented);
        const auto single =
            project_all(scan, support, implicit(op, Precision::kSingle, weight), queries, oriented);
        std::size_t far = 0, states = 0, redone = 0;
        for (std::size_t i = 0; i < queries.size(); ++i) {
          states += exact[i].status != single[i].status ? 1 : 0;
          redone += single[i].redone ? 1 : 0;
          far += size(exact[i].displacement - single[i].displacement) > 1e-4 * scan.spacing;
        }
        EXPECT_EQ(states, 0u);
        EXPECT_EQ(far, 0u);
        EXPECT_LT(redone, queries.size() / 5);
      }
}

TEST(ImplicitOperators, HalveTheNoiseOfAScan) {
  const double s = 0.02;  // so fine that curvature adds little
  for (const Surface& surface : {Surface(Torus{1, 0.4}), Surface(Sphere{1})}) {
    const Scan scan = scan_of(surface, s, 0.2 * s);
    for (const MlsOperator op : kImplicit) {
      const Errors errors = measure(scan, surface, {2 * s, 6 * s}, implicit(op), 600);
      EXPECT_GE(errors.moved, 590u);
      EXPECT_LT(errors.distance, 0.5 * 0.2 * s);
    }
  }
}

TEST(Rimls, LetsOutliersPullLessThanApssDoes) {
  const double s = 0.02;
  const Scan scan = scan_of(Sphere{1}, s);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Normal& n = scan.normals[i];
    World3 at = to_world(scan.lattice, scan.points[i]);
    if (i % 10 == 0) at = (1 + 1.5 * s) * at;
    points.push_back({at, {n[0], n[1], n[2]}});
  }
  const Scan dirty = sorted_scan(scan.lattice, points);
  const auto queries = some_queries(scan, 300);
  const auto error = [&](MlsOperator op) {
    const auto results = project_all(dirty, {2 * s, 6 * s}, implicit(op), queries);
    double sum = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const World3 at = to_world(scan.lattice, queries[i].position) + results[i].displacement;
      sum += (size(at) - 1) * (size(at) - 1);
    }
    return std::sqrt(sum / static_cast<double>(queries.size()));
  };
  EXPECT_LT(error(MlsOperator::kRimls), 0.6 * error(MlsOperator::kApss));
}

}  // namespace
}  // namespace pss::test
