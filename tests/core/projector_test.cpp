#include "core/projector.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/methods.h"
#include "tests/support/projection_comparison.h"

namespace pss::test {
namespace {

/// A surface, how it is sampled, and the noise in spacings.
struct Sampling {
  const char* name;
  Surface surface;
  double spacing;
  double noise;
};

std::vector<Sampling> samplings() {
  const Terrain terrain(12, 9);
  return {{"torus", Torus{1, 0.4}, 0.06, 0}, {"noisy_torus", Torus{1, 0.4}, 0.06, 0.2},
          {"sphere", Sphere{1}, 0.06, 0},    {"noisy_sphere", Sphere{1}, 0.06, 0.2},
          {"terrain", terrain, 0.16, 0},     {"noisy_terrain", terrain, 0.16, 0.2}};
}

/// Places of no point, up to 0.17 h off the samples.
std::vector<Query> places_near(const Scan& scan, double h, std::size_t count) {
  std::vector<Query> queries = some_queries(scan, count);
  Random random(7);
  for (Query& query : queries)
    for (double& c : query.remainder) c = 0.1 * h * random.uniform(-1, 1);
  return queries;
}

/// The default radius; the weight of PCL, which does not fall off before it, looks less far.
Support support_of(const Method& method, double h) {
  const double share = method.weight == WeightKind::kPcl ? 0.6 : 1;
  return {h, share * radius_factor(method.degree) * h};
}

class ProjectorOn : public testing::TestWithParam<Sampling> {};
INSTANTIATE_TEST_SUITE_P(Each, ProjectorOn, testing::ValuesIn(samplings()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(ProjectorOn, AnAnalyticSurfaceAgreesWithTheReferenceByEveryMethod) {
  const auto& [name, surface, s, noise] = GetParam();
  const Scan scan = scan_of(surface, s, noise * s, 0x1p-36);
  const double h = 2 * s;
  const std::vector<Query> queries = places_near(scan, h, 10);
  for (const Method& method : all_methods()) {
    const Support support = support_of(method, h);
    const Tolerance tolerance = tolerance_of(method);
    const std::vector<Projection> results = ScanProjector(scan, support, method)(queries);
    Agreement agreement;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      SCOPED_TRACE(name_of(method) + ", query " + std::to_string(i));
      const Projection expected = method.precision == Precision::kSingle
                                      ? oracle_at<double>(scan, queries[i], support, method)
                                      : oracle_at<long double>(scan, queries[i], support, method);
      expect_near(results[i], expected, s, h, tolerance, agreement);
    }
    EXPECT_GE(agreement.same, 10) << name_of(method);
    EXPECT_EQ(agreement.other_foot, 0) << name_of(method);
    EXPECT_EQ(agreement.other_state, 0) << name_of(method);
  }
}

TEST(Fast, GivesTheSurfaceOfLevin) {
  const double s = 0.03;
  const auto apart = [&](double noise, int degree) {  // root mean square, in spacings
    const Scan scan = scan_of(Torus{1, 0.4}, s, noise * s);
    const Support support{2 * s, radius_factor(degree) * 2 * s};
    const std::vector<Query> queries = some_queries(scan, 400);
    Method fast = levin(degree);
    fast.op = MlsOperator::kFast;
    const std::vector<Projection> a = ScanProjector(scan, support, levin(degree))(queries);
    const std::vector<Projection> b = ScanProjector(scan, support, fast)(queries);
    double square = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const World3 d = a[i].displacement - b[i].displacement;
      square += dot(d, d) / (s * s);
    }
    return std::sqrt(square / static_cast<double>(a.size()));
  };
  for (const int degree : {2, 3, 4}) {
    EXPECT_LT(apart(0, degree), 1e-6);
    EXPECT_LT(apart(0.2, degree), 1e-4);
  }
}

}  // namespace
}  // namespace pss::test
