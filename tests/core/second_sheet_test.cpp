#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/methods.h"
#include "tests/support/odd_clouds.h"

namespace pss::test {
namespace {

Projection project(const Points& points, const Method& method) {
  const OddCloud cloud = odd_cloud("", points);
  return ScanProjector(cloud.scan, {1, 3}, method)(cloud.queries[1]);
}

TEST(SecondSheet, IsSeenFromHalfAWidthToTwoAndAHalf) {
  for (const double apart : {0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 2.25, 2.5})
    for (const Method& method : all_methods({1, 3})) {
      SCOPED_TRACE(name_of(method) + ", " + std::to_string(apart));
      const Projection p = project(joined(flat(0), flat(apart)), method);
      EXPECT_EQ(p.second_sheet, moved(p.status));
    }
}

TEST(SecondSheet, IsNotSeenBeyondTheRadius) {
  for (const Method& method : all_methods({1, 3})) {
    SCOPED_TRACE(name_of(method));
    const Projection p = project(joined(flat(0), flat(3.25)), method);
    EXPECT_EQ(p.status, Status::kOk);
    EXPECT_FALSE(p.second_sheet);
  }
}

TEST(SecondSheet, IsNotSeenOnOneSheetThatIsNoisyBentOrEnds) {
  const double s = 0.05;
  const Scan torus = scan_of(Torus{1, 0.4}, s, 0.3 * s);
  const Scan terrain = scan_of(Terrain(6, 5), s, 0.3 * s, 0x1p-36);
  for (const Method& method : all_methods({1, 3}))
    for (const Scan* scan : {&torus, &terrain}) {
      if (method.weight == WeightKind::kPcl) continue;  // weighs all that lies across the tube
      SCOPED_TRACE(name_of(method));
      const std::vector<Projection> results =
          ScanProjector(*scan, {2 * s, 6 * s}, method)(some_queries(*scan, 200));
      EXPECT_EQ(std::ranges::count(results, true, &Projection::second_sheet), 0);
    }
}

}  // namespace
}  // namespace pss::test
