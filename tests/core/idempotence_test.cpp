#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/methods.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

/// What projecting a second time, from the unrounded first result, changes.
struct Second {
  double farthest = 0;        ///< in spacings, of the points that reach the same foot
  std::size_t same = 0;       ///< points ok in both passes that reach the same foot
  std::size_t elsewhere = 0;  ///< ok in both, but more than a thousandth of a spacing apart
  std::size_t not_ok = 0;     ///< in either pass
};

Second project_twice(const Scan& scan, const Support& support, const Method& method) {
  ScanProjector project(scan, support, method);
  std::vector<Query> queries = some_queries(scan, 300);
  const std::vector<Projection> first = project(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) queries[i].remainder = first[i].displacement;
  const std::vector<Projection> second = project(queries);
  Second result;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const World3& d = second[i].displacement;
    const double moved = std::sqrt(dot(d, d)) / scan.spacing;
    if (first[i].status != Status::kOk || second[i].status != Status::kOk) {
      ++result.not_ok;
    } else if (moved > 1e-3) {
      ++result.elsewhere;
    } else {
      ++result.same;
      result.farthest = std::max(result.farthest, moved);
    }
  }
  return result;
}

/// How far a second pass may move a point, in spacings.
///
/// levin is a projection, to the last digits. fast ends where a pass turns and moves its plane by
/// 1e-3, apss and rimls where a step is 1e-6 h: the last of a series that falls fast. The weight
/// of Wendland sees less far than a Gaussian, so that edges determine its cubics less well.
double most_moved(const Method& method) {
  if (method.op == MlsOperator::kFast) return 1e-4;
  if (needs_normals(method.op)) return method.precision == Precision::kSingle ? 1e-5 : 1e-6;
  if (method.precision == Precision::kDouble) return 1e-12;
  return method.weight == WeightKind::kWendland ? 5e-5 : 1e-5;
}

/// The weight of PCL is cut off about the query: what it gives is no projection.
std::vector<Method> projections() {
  std::vector<Method> methods = all_methods();
  std::erase_if(methods, [](const Method& m) { return m.weight == WeightKind::kPcl; });
  return methods;
}

class SecondPass : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(OverNoise, SecondPass, testing::Values(0.0, 0.1, 0.3));

TEST_P(SecondPass, LeavesPointsWhereTheFirstPassPutThem) {
  const double noise = GetParam();
  const Scan torus = scan_of(Torus{1, 0.4}, 0.04, noise * 0.04);
  const Scan terrain = scan_of(Terrain(12, 9), 0.16, noise * 0.16, 0x1p-36);
  for (const Method& method : projections())
    for (const Scan* scan : {&torus, &terrain}) {
      SCOPED_TRACE(name_of(method));
      const double h = 3 * scan->spacing;
      const Second second = project_twice(*scan, {h, radius_factor(method.degree) * h}, method);
      EXPECT_LT(second.farthest, most_moved(method));
      EXPECT_GE(second.same, 300u);
      EXPECT_LE(second.elsewhere, 1u);
      EXPECT_LE(second.not_ok, 1u);
    }
}

}  // namespace
}  // namespace pss::test
