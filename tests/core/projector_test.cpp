#include "core/projector.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/support/methods.h"
#include "tests/support/projection_comparison.h"

namespace pss::test {
namespace {

struct Cloud {
  std::string name;
  Scan scan;
};

/// Three surfaces, each sampled without noise and with 0.2 spacings of it.
std::vector<Cloud> analytic_clouds() {
  std::vector<Cloud> clouds;
  for (const double noise : {0.0, 0.2}) {
    const std::string suffix = noise > 0 ? ", noisy" : "";
    clouds.push_back({"torus" + suffix, scan_of(Torus{1, 0.4}, 0.06, noise * 0.06)});
    clouds.push_back({"sphere" + suffix, scan_of(Sphere{1}, 0.06, noise * 0.06)});
    clouds.push_back({"terrain" + suffix, scan_of(Terrain(12, 9), 0.16, noise * 0.16, 0x1p-36)});
  }
  return clouds;
}

/// Places of no point, up to 0.17 h off the samples.
std::vector<Query> places_near(const Scan& scan, double h, std::size_t count) {
  std::vector<Query> queries = some_queries(scan, count);
  Random random(7);
  for (Query& query : queries)
    for (double& c : query.remainder) c = 0.1 * h * random.uniform(-1, 1);
  return queries;
}

/// What rounding leaves; the residual is a difference, about 1e-8 of the heights at best.
Tolerance tolerance_of(const Method& method) {
  Tolerance t{1e-11, 1e-10, 1e-9, 4e-9, 1e-8, 1e-11, 0};
  if (method.precision == Precision::kSingle) t = {1e-4, 1e-4, 2e-3, 1e-2, 5e-4, 1e-4, 2};
  if (method.op == MlsOperator::kRimls) t.direction = 0.2;  // its normal is not the polynomial's
  return t;
}

/// The default radius; the weight of PCL, which does not fall off before it, looks less far.
Support support_of(const Method& method, double h) {
  const double share = method.weight == WeightKind::kPcl ? 0.6 : 1;
  return {h, share * radius_factor(method.degree) * h};
}

class ProjectorOf : public testing::TestWithParam<Method> {};

TEST_P(ProjectorOf, AgreesWithTheReferenceOnAnalyticSurfaces) {
  const Method method = GetParam();
  const Tolerance tolerance = tolerance_of(method);
  Agreement agreement;
  for (const auto& [name, scan] : analytic_clouds()) {
    const double h = 2 * scan.spacing;
    const Support support = support_of(method, h);
    ScanProjector project(scan, support, method);
    const std::vector<Query> queries = places_near(scan, h, 16);
    const std::vector<Projection> results = project(queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      SCOPED_TRACE(name + ", query " + std::to_string(i));
      const Projection expected = method.precision == Precision::kSingle
                                      ? oracle_at<double>(scan, queries[i], support, method)
                                      : oracle_at<long double>(scan, queries[i], support, method);
      expect_near(results[i], expected, scan.spacing, h, tolerance, agreement);
    }
  }
  EXPECT_GE(agreement.same, 96);
  EXPECT_EQ(agreement.other_foot, 0);
  EXPECT_EQ(agreement.other_state, 0);
}

INSTANTIATE_TEST_SUITE_P(Each, ProjectorOf, testing::ValuesIn(all_methods()), method_name);

}  // namespace
}  // namespace pss::test
