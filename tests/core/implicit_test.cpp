#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/simd/targets.h"
#include "tests/support/methods.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

constexpr std::array kImplicit{MlsOperator::kApss, MlsOperator::kRimls};

Method implicit(MlsOperator op, Precision precision = Precision::kDouble,
                WeightKind weight = WeightKind::kGaussian) {
  return {op, weight, precision, 3};
}

/// Projects places of a scan with its normals, oriented or of unknown side.
std::vector<Projection> project_all(const Scan& scan, const Support& support, const Method& method,
                                    std::span<const Query> queries, bool oriented = true,
                                    std::size_t batch = 1000) {
  const CellGrid grid(scan.lattice, scan.points, reach(method.weight, support));
  Projector projector(grid, method, {scan.normals, oriented});
  std::vector<Projection> results(queries.size());
  for (std::size_t i = 0; i < queries.size(); i += batch) {
    const std::size_t count = std::min(batch, queries.size() - i);
    projector.project(queries.subspan(i, count), {&support, 1},
                      std::span(results).subspan(i, count));
  }
  return results;
}

/// The projection of the origin, h = 1, R = 3, with what lies around it.
Projection project_origin(const std::vector<SurfacePoint>& around, const Method& method,
                          bool oriented = true) {
  const Scan scan = sorted_scan({{0x1p-30, 0x1p-30, 0x1p-30}, {0, 0, 0}}, around);
  return project_all(scan, {1, 3}, method, std::vector<Query>(1), oriented)[0];
}

bool same(const Projection& a, const Projection& b) {
  return a.status == b.status && a.second_sheet == b.second_sheet && a.neighbours == b.neighbours &&
         a.displacement == b.displacement && a.normal == b.normal &&
         a.mean_curvature == b.mean_curvature && a.gaussian_curvature == b.gaussian_curvature &&
         a.principal_direction == b.principal_direction && a.residual == b.residual &&
         a.boundary == b.boundary && a.redone == b.redone;
}

std::size_t differing(const std::vector<Projection>& a, const std::vector<Projection>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += same(a[i], b[i]) ? 0u : 1u;
  return count;
}

double size(const World3& v) { return std::sqrt(dot(v, v)); }

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

/// A square grid of points in z = height, about the origin.
std::vector<SurfacePoint> sheet(double height, double up = 1) {
  std::vector<SurfacePoint> points;
  for (int i = -16; i <= 16; ++i)
    for (int j = -16; j <= 16; ++j) points.push_back({{0.25 * i, 0.25 * j, height}, {0, 0, up}});
  return points;
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
      EXPECT_EQ(differing(before, after), 0u);
    }
}

TEST(ImplicitOperators, GiveTheSameBitsInEveryTargetAndBatch) {
  Scan scan = rough_torus();
  const Support support{0.12, 0.36};
  const auto queries = some_queries(scan, 120);
  for (const bool oriented : {true, false}) {
    if (!oriented) turn_every_third(scan);
    for (const Method& method : methods_of({MlsOperator::kApss, MlsOperator::kRimls})) {
      const auto expected = project_all(scan, support, method, queries, oriented);
      for (const std::size_t batch : {1u, 2u, 3u, 17u})
        EXPECT_EQ(differing(expected, project_all(scan, support, method, queries, oriented, batch)),
                  0u);
      for (const simd::Target& target : simd::targets()) {
        const simd::ForcedTarget forced(target);
        const auto results = project_all(scan, support, method, queries, oriented);
        EXPECT_EQ(differing(expected, results), 0u) << target.name;
      }
    }
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

/// Neighbourhoods that are hardly or not at all a piece of a surface, by name.
std::map<std::string, std::vector<SurfacePoint>> odd_neighbourhoods() {
  std::map<std::string, std::vector<SurfacePoint>> odd;
  const World3 up{0, 0, 1};
  const std::vector<SurfacePoint> few{{{0, 0, 0}, up},
                                      {{0.5, 0, 0}, up},
                                      {{0, 0.7, 0.1}, up},
                                      {{-0.4, -0.3, 0}, {0.6, 0, 0.8}},
                                      {{0.2, -0.6, 0.2}, up}};
  for (std::size_t n = 0; n <= few.size(); ++n)
    odd["first " + std::to_string(n)] = {few.begin(), few.begin() + static_cast<long>(n)};
  odd["identical"] = std::vector<SurfacePoint>(50, {{0, 0, 0}, up});
  odd["identical elsewhere"] = std::vector<SurfacePoint>(50, {{0.3, 0.2, -0.125}, up});
  odd["identical and far"] = std::vector<SurfacePoint>(50, {{0.3, 0.2, 0.7}, up});
  odd["sheet"] = sheet(0.25);
  odd["sheet too far"] = sheet(0.75);
  odd["sheet without normals"] = sheet(0.25, 0);
  odd["few normals"] = sheet(0.25, 0);
  for (std::size_t i = 500; i < 502; ++i) odd["few normals"][i].normal = up;
  for (int i = -20; i <= 20; ++i) {
    const double a = 0.07 * i;
    odd["line"].push_back({{a, 2 * a, -a}, {0.8, 0, 0.6}});
    odd["opposite"].push_back({{a, 0, 0}, {0, 0, i % 2 == 0 ? 1.0 : -1.0}});
    odd["opposite"].push_back({{a, 0, 0}, {0, 0, i % 2 == 0 ? -1.0 : 1.0}});
  }
  odd["beyond the radius"] = {{{3.1, 0, 0}, up}, {{0, 3.1, 0}, up}, {{-3.1, 0.5, 0}, up}};
  odd["hardly weighted"] = {{{2.99, 0, 0}, up}, {{0, 2.98, 0.3}, up}, {{-2.99, 0.1, 0}, up}};
  Random random(12);
  for (int i = 0; i < 300; ++i) {
    const World3 v{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    const World3 n{random.normal(), random.normal(), random.normal()};
    odd["volume"].push_back({v, normalized(n)});
    odd["shell"].push_back({1.2 * normalized(v), normalized(v)});
  }
  return odd;
}

class ImplicitMethods : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, ImplicitMethods,
                         testing::ValuesIn(methods_of({MlsOperator::kApss, MlsOperator::kRimls})),
                         method_name);

TEST_P(ImplicitMethods, GiveEveryOddNeighbourhoodAStatusAndNoNaN) {
  for (const auto& [name, points] : odd_neighbourhoods())
    for (const bool oriented : {true, false}) {
      SCOPED_TRACE(name);
      const Projection p = project_origin(points, GetParam(), oriented);
      for (const World3& v : {p.displacement, p.normal, p.principal_direction})
        EXPECT_TRUE(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]));
      EXPECT_TRUE(std::isfinite(p.mean_curvature) && std::isfinite(p.gaussian_curvature));
      EXPECT_TRUE(std::isfinite(p.residual) && std::isfinite(p.boundary));
      EXPECT_LT(size(p.displacement), 0.5);
      EXPECT_NEAR(dot(p.normal, p.normal), moved(p.status) ? 1 : 0, 1e-6);
      EXPECT_TRUE(moved(p.status) || p.displacement == (World3{0, 0, 0}));
    }
}

TEST_P(ImplicitMethods, NameWhyAPointStays) {
  const auto odd = odd_neighbourhoods();
  const std::map<std::string, Status> expected{{"first 0", Status::kTooFew},
                                               {"first 1", Status::kTooFew},
                                               {"first 2", Status::kTooFew},
                                               {"first 3", Status::kOk},
                                               {"first 5", Status::kOk},
                                               {"identical", Status::kOk},
                                               {"identical elsewhere", Status::kOk},
                                               {"identical and far", Status::kOutOfDomain},
                                               {"line", Status::kOk},
                                               {"sheet", Status::kOk},
                                               {"sheet too far", Status::kOutOfDomain},
                                               {"sheet without normals", Status::kTooFew},
                                               {"few normals", Status::kTooFew},
                                               {"opposite", Status::kDegenerate},
                                               {"beyond the radius", Status::kTooFew}};
  for (const auto& [name, status] : expected)
    EXPECT_EQ(project_origin(odd.at(name), GetParam()).status, status) << name;
}

TEST(ImplicitOperators, CountPointsWithoutNormalsAsNeighboursOnly) {
  for (const MlsOperator op : kImplicit) {
    std::vector<SurfacePoint> points = sheet(0.25);
    const Projection all = project_origin(points, implicit(op));
    const std::vector<SurfacePoint> others = sheet(0.5, 0);
    points.insert(points.end(), others.begin(), others.end());
    const Projection both = project_origin(points, implicit(op));
    EXPECT_EQ(both.displacement, all.displacement);
    EXPECT_GT(both.neighbours, 2 * all.neighbours - 30);
  }
}

}  // namespace
}  // namespace pss::test
