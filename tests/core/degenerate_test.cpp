#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "core/simd/targets.h"
#include "tests/support/batches.h"
#include "tests/support/methods.h"
#include "tests/support/odd_clouds.h"
#include "tests/support/projection_comparison.h"

namespace pss::test {
namespace {

constexpr Support kSupport{1, 3};

bool is_finite(const World3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

bool is_zero(const World3& v) { return v == World3{0, 0, 0}; }

void expect_defined(const Projection& p, const Method& method, double h = 1) {
  const bool known = moved(p.status) || p.status == Status::kTooFew ||
                     p.status == Status::kDegenerate || p.status == Status::kOutOfDomain;
  EXPECT_TRUE(known);
  EXPECT_TRUE(is_finite(p.displacement) && is_finite(p.normal) && is_finite(p.principal_direction));
  EXPECT_TRUE(std::isfinite(p.mean_curvature) && std::isfinite(p.gaussian_curvature));
  EXPECT_TRUE(std::isfinite(p.residual) && std::isfinite(p.boundary));
  EXPECT_GE(p.residual, 0);
  EXPECT_GE(p.boundary, 0);
  EXPECT_LE(p.boundary, 1 + 1e-5);
  if (!moved(p.status)) {
    EXPECT_TRUE(is_zero(p.displacement) && is_zero(p.normal) && is_zero(p.principal_direction));
    EXPECT_FALSE(p.second_sheet);
    return;
  }
  EXPECT_LT(length(p.displacement), (needs_normals(method.op) ? 0.5 : 1.0) * h);
  EXPECT_NEAR(length(p.normal), 1, 1e-6);
  if (!is_zero(p.principal_direction)) {
    EXPECT_NEAR(length(p.principal_direction), 1, 1e-6);
    EXPECT_TRUE(is_canonical(p.principal_direction));
  }
}

struct Group {
  std::string name;
  std::vector<OddCloud> (*clouds)();
};

std::vector<Group> groups() {
  return {{"few_points", few_points}, {"lines", lines},   {"ties", ties},        {"sheets", sheets},
          {"bends", bends},           {"crowds", crowds}, {"lattices", lattices}};
}

class OddNeighbourhoods : public testing::TestWithParam<Group> {};
INSTANTIATE_TEST_SUITE_P(All, OddNeighbourhoods, testing::ValuesIn(groups()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(OddNeighbourhoods, HaveADefinedResultThatIsTheSameInAllCompany) {
  for (const OddCloud& cloud : GetParam().clouds())
    for (const Method& method : all_methods({1, 3, 4})) {
      SCOPED_TRACE(cloud.name + ", " + name_of(method));
      const std::vector<Projection> results =
          expect_same_in_all_company(cloud.scan, kSupport, method, cloud.queries);
      for (const Projection& p : results) expect_defined(p, method);
    }
}

TEST_P(OddNeighbourhoods, HaveADefinedResultHoweverFarTheyAreLookedAt) {
  for (const OddCloud& cloud : GetParam().clouds())
    for (const Method& method : all_methods({4})) {
      if (method.weight != WeightKind::kGaussian) continue;
      for (const double h : {1e-150, 1e-8, 0.05, 1.0, 3.0})
        for (const double factor : {1.0, 3.0, 40.0, 1e12}) {
          SCOPED_TRACE(
              fmt::format("{}, {}, h {}, radius {} h", cloud.name, name_of(method), h, factor));
          const Support support{h, factor * h};
          for (const Projection& p : ScanProjector(cloud.scan, support, method)(cloud.queries))
            expect_defined(p, method, h);
        }
    }
}

struct Expected {
  const char* name;
  Points points;
  Status status;
};

TEST(Degenerate, NeighbourhoodsNameWhyAPointStays) {
  const Points few{{0, 0, 0}, {0.5, 0, 0}, {0, 0.7, 0.1}, {-0.4, -0.3, 0}, {0.2, -0.6, 0.2}};
  const auto first = [&](std::ptrdiff_t n) { return Points(few.begin(), few.begin() + n); };
  const Points same(50, {0, 0, 0});
  const Points crowd(100000, {0.25, 0, 0});
  Points line, rod, octahedron;
  Random random(12);
  for (int i = -60; i <= 60; ++i) {
    const double a = 0.0625 * i;
    line.push_back({a, 2 * a, -a});
    rod.push_back({a, 1e-8 * random.uniform(-1, 1), 1e-8 * random.uniform(-1, 1)});
  }
  for (const double a : {-1, 1}) octahedron = joined(octahedron, {{a, 0, 0}, {0, a, 0}, {0, 0, a}});
  for (const Expected& e :
       {Expected{"none", {}, Status::kTooFew},
        {"one", first(1), Status::kTooFew},
        {"two", first(2), Status::kTooFew},
        {"three", first(3), Status::kDegreeReduced},
        {"five", first(5), Status::kDegreeReduced},
        {"one place", same, Status::kDegenerate},
        {"two places", joined(same, {{0.4, 0, 0}}), Status::kDegenerate},
        {"three places", joined(crowd, {{0.4, 0, 0}, {0, 1, 0}}), Status::kDegreeReduced},
        {"line", line, Status::kDegenerate},
        {"rod", rod, Status::kDegenerate},
        {"octahedron", octahedron, Status::kDegenerate},
        {"beyond the radius",
         {{3.1, 0, 0}, {0, 3.1, 0}, {-3.1, 0.5, 0}, {0, -3.1, 0.4}},
         Status::kTooFew},
        {"plane", flat(0), Status::kOk},
        {"plane with a crowd", joined(flat(0), crowd), Status::kOk}})
    EXPECT_EQ(project_origin(e.points, kSupport, levin(3)).status, e.status) << e.name;
}

TEST_P(OddNeighbourhoods, HaveTheSameBitsInEveryTarget) {
  for (const OddCloud& cloud : GetParam().clouds())
    for (const Method& method : all_methods()) {
      SCOPED_TRACE(cloud.name + ", " + name_of(method));
      const auto widest = ScanProjector(cloud.scan, kSupport, method)(cloud.queries);
      for (const simd::Target& target : simd::targets()) {
        const simd::ForcedTarget forced(target);
        const auto results = ScanProjector(cloud.scan, kSupport, method)(cloud.queries);
        EXPECT_EQ(count_different(results, widest), 0u) << target.name;
      }
    }
}

TEST_P(OddNeighbourhoods, AgreeWithTheReference) {
  for (const OddCloud& cloud : GetParam().clouds())
    for (const Method& method : all_methods({3})) {
      SCOPED_TRACE(cloud.name + ", " + name_of(method));
      const Query& query = cloud.queries[1];  // off the symmetries, where comparisons would tie
      Agreement agreement;
      expect_near(ScanProjector(cloud.scan, kSupport, method)(query),
                  oracle_at<long double>(cloud.scan, query, kSupport, method), 0.25, 1,
                  tolerance_of(method), agreement);
      EXPECT_EQ(agreement.same, 1);
    }
}

TEST(AHundredThousandNeighbours, HaveADefinedResultThatIsTheSameInEveryTarget) {
  for (const OddCloud& cloud : multitudes())
    for (const Method& method : all_methods({3})) {
      if (method.weight != WeightKind::kGaussian) continue;
      SCOPED_TRACE(cloud.name + ", " + name_of(method));
      const Projection widest = ScanProjector(cloud.scan, kSupport, method)(cloud.queries[1]);
      expect_defined(widest, method);
      for (const simd::Target& target : simd::targets()) {
        const simd::ForcedTarget forced(target);
        const Projection p = ScanProjector(cloud.scan, kSupport, method)(cloud.queries[1]);
        EXPECT_TRUE(same_bits(p, widest)) << target.name;
      }
    }
}

}  // namespace
}  // namespace pss::test
