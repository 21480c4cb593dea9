#include "stream/passes/key_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/morton.h"
#include "stream/store/block.h"
#include "tests/support/cloud.h"

namespace pss::test {
namespace {

/// Half of the points in a corner of a millionth of the others' side.
std::vector<Index3> two_densities(std::size_t count) {
  Random random(7);
  std::vector<Index3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double side = i % 2 ? 1e3 : 1e9;
    points.push_back({static_cast<std::int64_t>(random.uniform(0, side)),
                      static_cast<std::int64_t>(random.uniform(0, side)), 0});
  }
  std::ranges::sort(points, {}, encode_key);
  return points;
}

TEST(KeyGroups, CoverAllPointsInOrderWithAtMostSoManyEach) {
  const std::vector<Index3> points = two_densities(5000);
  std::size_t end = 0;
  for (const PointRange& group : key_groups(points, 100)) {
    EXPECT_EQ(group.begin, end);
    EXPECT_LE(group.end - group.begin, 100u);
    end = group.end;
  }
  EXPECT_EQ(end, points.size());
}

TEST(KeyGroups, DoNotSpanTwoDensities) {
  const std::vector<Index3> points = two_densities(5000);
  int small = 0, between = 0;
  for (const PointRange& group : key_groups(points, 100)) {
    const IndexBox box = box_of(std::span(points).subspan(group.begin, group.end - group.begin));
    const std::int64_t side = std::max(box.max[0] - box.min[0], box.max[1] - box.min[1]);
    small += side <= 1000;
    between += side > 1000 && box.min[0] < 1000 && box.min[1] < 1000;
  }
  EXPECT_GE(small, 25);
  EXPECT_LE(between, 1);
}

TEST(KeyGroups, LeaveCopiesOfOnePlaceTogether) {
  std::vector<Index3> points(300, Index3{5, 5, 5});
  points.push_back({6, 5, 5});
  const std::vector<PointRange> groups = key_groups(points, 10);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].end, 300u);
}

TEST(KeyGroups, EndWhereTheOrderIsNoOrder) {
  std::vector<Index3> points;
  for (std::int64_t i = 0; i < 3000; ++i) points.push_back({i % 2 ? i : -i, 0, 0});
  std::size_t covered = 0;
  for (const PointRange& group : key_groups(points, 1)) covered += group.end - group.begin;
  EXPECT_EQ(covered, points.size());
  EXPECT_TRUE(key_groups({}, 1).empty());
}

}  // namespace
}  // namespace pss::test
