#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/core/implicit_fixture.h"

namespace pss::test {
namespace {

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
