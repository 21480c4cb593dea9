#include "core/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/cloud.h"

namespace pss::test {
namespace {

IndexBox random_box(Random& random, std::int64_t side) {
  IndexBox box;
  for (int i = 0; i < 2; ++i)
    box.add(Index3{random.integer(-side, side), random.integer(-side, side),
                   random.integer(-side, side)});
  return box;
}

Index3 random_in(Random& random, const IndexBox& box) {
  Index3 p;
  for (std::size_t a = 0; a < 3; ++a) p[a] = random.integer(box.min[a], box.max[a]);
  return p;
}

TEST(Lattice, TakesEveryIndexToTheWorldAndBack) {
  Random random(1);
  const Lattice lattices[] = {{{1, 1, 1}, {}},
                              {{0.01, 0.01, 0.001}, {500000, 4600000, 0}},
                              {{0x1p-20, 0x1p-20, 0x1p-20}, {0.25, -3, 17}}};
  for (const Lattice& lattice : lattices)
    for (int i = 0; i < 1000; ++i) {
      const Index3 index{random.integer(-1000000, 1000000), random.integer(-1000000, 1000000),
                         random.integer(-1000000, 1000000)};
      EXPECT_EQ(to_index(lattice, to_world(lattice, index)), index);
    }
}

TEST(Lattice, MovesAPositionByHalfAStepAtMost) {
  const Lattice lattice{{0.25, 0.5, 2}, {10, -20, 0.5}};
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const World3 p{random.uniform(-99, 99), random.uniform(-99, 99), random.uniform(-99, 99)};
    const World3 q = to_world(lattice, to_index(lattice, p));
    for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(std::abs(q[a] - p[a]), lattice.scale[a] / 2);
  }
}

TEST(Lattice, RefusesWhatDoesNotFit) {
  const Lattice lattice;
  EXPECT_TRUE(on_lattice(lattice, World3{0x1p41 - 2, -0x1p41 + 2, 0}));
  EXPECT_FALSE(on_lattice(lattice, World3{0x1p41, 0, 0}));
  EXPECT_FALSE(on_lattice(lattice, World3{0, 0, -0x1p42}));
  EXPECT_FALSE(on_lattice(lattice, World3{0, 1e308, 0}));
  EXPECT_FALSE(on_lattice(lattice, World3{0, std::nan(""), 0}));
  EXPECT_FALSE(on_lattice(lattice, World3{std::numeric_limits<double>::infinity(), 0, 0}));
  EXPECT_TRUE(on_lattice(Index3{kLatticeMin, 0, kLatticeMax}));
  EXPECT_FALSE(on_lattice(Index3{kLatticeMin - 1, 0, 0}));
  EXPECT_FALSE(on_lattice(Index3{0, 0, kLatticeMax + 1}));
}

TEST(DistanceSq, IsThatOfWorldLengths) {
  const Lattice lattice{{0.5, 0.25, 2}, {1e6, -1e6, 3}};
  EXPECT_EQ(distance_sq(lattice, Index3{10, 20, 30}, Index3{16, 36, 36}), 9 + 16 + 144);
}

TEST(DistanceSq, IsTheSameBothWays) {
  const Lattice lattice{{0.013, 0.7, 1.1}, {}};
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const IndexBox box = random_box(random, kLatticeMax / 2);
    EXPECT_EQ(distance_sq(lattice, box.min, box.max), distance_sq(lattice, box.max, box.min));
  }
}

TEST(DistanceSq, ToABoxIsNeverMoreThanToAPointOfIt) {
  Random random(4);
  for (const World3& scale : {World3{1, 1, 1}, World3{0.01, 0.01, 0.001}, World3{0.1, 3, 1e-7}}) {
    const Lattice lattice{scale, {}};
    for (int i = 0; i < 2000; ++i) {
      const IndexBox a = random_box(random, 3000);
      const IndexBox b = random_box(random, 3000);
      const Index3 p = random_in(random, a);
      const Index3 q = random_in(random, b);
      EXPECT_LE(distance_sq(lattice, p, b), distance_sq(lattice, p, q));
      EXPECT_LE(distance_sq(lattice, a, b), distance_sq(lattice, p, b));
    }
  }
}

TEST(DistanceSq, ToABoxIsReachedByItsNearestPoint) {
  const IndexBox box{{-5, -5, -5}, {5, 5, 5}};
  EXPECT_EQ(distance_sq({}, Index3{8, 0, 0}, box), 9);
  EXPECT_EQ(distance_sq({}, Index3{8, -9, 3}, box), 25);
  EXPECT_EQ(distance_sq({}, Index3{5, -5, 0}, box), 0);
  EXPECT_EQ(distance_sq({}, box, IndexBox{{8, 9, 0}, {10, 10, 100}}), 25);
  EXPECT_EQ(distance_sq({}, box, IndexBox{{-8, -9, 0}, {-6, -6, 100}}), 2);
}

TEST(Boxes, AreEmptyUntilSomethingIsAdded) {
  IndexBox box;
  EXPECT_TRUE(box.empty());
  box.add(IndexBox{});
  EXPECT_TRUE(box.empty());
  box.add(Index3{1, 2, 3});
  EXPECT_EQ(box, (IndexBox{{1, 2, 3}, {1, 2, 3}}));
  WorldBox world;
  world.add(WorldBox{});
  EXPECT_TRUE(world.empty());
}

TEST(LatticeFor, TakesThePowerOfTwoAtOrAboveTheLongestSide) {
  const auto step = [](double side) {
    return lattice_for({{0, 0, 0}, {side / 3, side, 0}}).scale[0];
  };
  EXPECT_EQ(step(1), 0x1p-41);
  EXPECT_EQ(step(std::nextafter(1, 2)), 0x1p-40);
  EXPECT_EQ(step(1000), 0x1p-31);
  EXPECT_EQ(step(0.3), 0x1p-42);
}

TEST(LatticeFor, TakesTheLargestCoordinateWhereThereIsNoExtent) {
  EXPECT_EQ(lattice_for({{3, -5, 0}, {3, -5, 0}}).scale, (World3{0x1p-38, 0x1p-38, 0x1p-38}));
  EXPECT_EQ(lattice_for({{0, 0, 0}, {0, 0, 0}}), Lattice{});
  EXPECT_EQ(lattice_for({}), Lattice{});
}

TEST(LatticeFor, PutsTheOriginOnTheStepNearestTheCentreAndHoldsTheBox) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    WorldBox box;
    for (int k = 0; k < 2; ++k)
      box.add(World3{random.uniform(-1e7, 1e7), random.uniform(4e6, 5e6), random.uniform(0, 9)});
    const Lattice lattice = lattice_for(box);
    for (std::size_t a = 0; a < 3; ++a) {
      const double centre = (box.min[a] + box.max[a]) / 2;
      EXPECT_LE(std::abs(lattice.origin[a] - centre), lattice.scale[a]);
      EXPECT_EQ(std::remainder(lattice.origin[a], lattice.scale[a]), 0);
    }
    EXPECT_TRUE(on_lattice(lattice, box.min));
    EXPECT_TRUE(on_lattice(lattice, box.max));
  }
}

TEST(LatticeFor, KeepsFloatCoordinatesExactly) {  // here of 24 bits below 2^-3
  Random random(6);
  std::vector<World3> points(500);
  WorldBox box;
  for (World3& p : points) {
    for (double& c : p) c = 0x1p-27 * static_cast<double>(random.integer(-(1 << 23), 1 << 24));
    box.add(p);
  }
  const Lattice lattice = lattice_for(box);
  for (const World3& p : points) EXPECT_EQ(to_world(lattice, to_index(lattice, p)), p);
}

}  // namespace
}  // namespace pss::test
