#include "stream/passes/box_tree.h"

#include <gtest/gtest.h>

#include "tests/support/cloud.h"

namespace pss {
namespace {

std::vector<IndexBox> random_boxes(std::size_t count, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<IndexBox> boxes(count);
  for (IndexBox& box : boxes) {
    const Index3 corner{random.integer(-1000, 1000), random.integer(-1000, 1000),
                        random.integer(-1000, 1000)};
    box.add(corner);
    box.add(Index3{corner[0] + random.integer(0, 60), corner[1] + random.integer(0, 60),
                   corner[2] + random.integer(0, 60)});
  }
  return boxes;
}

TEST(BoxTree, FindsTheSameBoxesAsALoopOverAllOfThem) {
  const Lattice lattice{{0.5, 1, 2}, {100, 200, 300}};
  for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 65u, 1000u}) {
    const std::vector<IndexBox> boxes = random_boxes(count, count + 1);
    const BoxTree tree(boxes);
    for (const IndexBox& box : random_boxes(20, 99)) {
      const double reach = 150;
      std::vector<std::size_t> expected;
      for (std::size_t i = 0; i < count; ++i)
        if (distance_sq(lattice, boxes[i], box) <= reach * reach) expected.push_back(i);

      EXPECT_EQ(tree.within(lattice, box, reach), expected);
    }
  }
}

TEST(BoxTree, LeavesOutEmptyBoxes) {
  std::vector<IndexBox> boxes(3);
  boxes[1].add(Index3{1, 2, 3});
  const BoxTree tree(boxes);

  EXPECT_EQ(tree.within(Lattice{}, boxes[1], 1e12), (std::vector<std::size_t>{1}));
}

}  // namespace
}  // namespace pss
