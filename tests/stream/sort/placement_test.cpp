#include "stream/sort/placement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pss {
namespace {

Lattice grid(double scale, double origin) {
  return {{scale, scale, scale}, {origin, origin, origin}};
}

PointBatch batch_of(const Index3& index) {
  PointBatch batch;
  batch.index = {index};
  return batch;
}

PointBatch batch_of(const World3& world) {
  PointBatch batch;
  batch.world = {world};
  return batch;
}

TEST(Align, FindsDecimalGridsThatAreShiftedByWholeSteps) {
  for (const double scale : {0.01, 0.001, 0.0025, 1e-5})
    for (const double origin : {0.0, 1000.0, 500000.0, -4100000.0}) {
      const auto map = align(grid(scale, origin + 300), grid(scale, origin));
      ASSERT_TRUE(map.has_value()) << scale << " " << origin;
      EXPECT_EQ(map->multiple, (Index3{1, 1, 1}));
      EXPECT_EQ(map->shift[0], std::llrint(300 / scale));
    }
}

TEST(Align, FindsCoarserGridsWithinFinerOnes) {
  const auto map = align(grid(0.01, 500010), grid(0.001, 500000));

  ASSERT_TRUE(map.has_value());
  EXPECT_EQ(map->multiple, (Index3{10, 10, 10}));
  EXPECT_EQ(map->shift, (Index3{10000, 10000, 10000}));
}

TEST(Align, RefusesGridsThatFallBetweenSteps) {
  EXPECT_FALSE(align(grid(0.01, 0.005), grid(0.01, 0)).has_value());
  EXPECT_FALSE(align(grid(0.01, 100.001), grid(0.01, 0)).has_value());
  EXPECT_FALSE(align(grid(0.015, 0), grid(0.01, 0)).has_value());
  EXPECT_FALSE(align(grid(0.001, 0), grid(0.01, 0)).has_value());
  EXPECT_FALSE(align(grid(1e-300, 0), grid(1e300, 0)).has_value());
}

TEST(Placement, KeepsEveryIntegerOfAnAlignedGrid) {
  const Placement placement(grid(0.01, 600000), grid(0.01, 500000));
  Index3 out{};
  double move = -1;

  const Placed placed = placement.place(batch_of(Index3{2147483647, -2147483648, 5}), 0, out, move);

  EXPECT_EQ(placed, Placed::kExact);
  EXPECT_EQ(out, (Index3{2147483647 + 10000000ll, -2147483648 + 10000000ll, 10000005}));
  EXPECT_EQ(move, 0);
}

TEST(Placement, MovesPointsOfOtherGridsByAtMostHalfAStep) {
  const Lattice lattice = grid(0.001, 500000);
  const Placement placement(grid(0.001, 500000.0004), lattice);
  Index3 out{};
  double move = 0;
  EXPECT_FALSE(placement.exact());

  EXPECT_EQ(placement.place(batch_of(Index3{123456, 0, -5}), 0, out, move), Placed::kMoved);

  EXPECT_EQ(out, (Index3{123456, 0, -5}));
  EXPECT_NEAR(move, 0.0004 * std::sqrt(3.0), 1e-9);
}

TEST(Placement, TellsExactMovedAndHopelessFloats) {
  const Lattice lattice = grid(0.25, 8);
  const Placement placement(std::nullopt, lattice);
  Index3 out{};
  double move = 0;
  EXPECT_EQ(placement.place(batch_of(World3{8.25, -1, 8}), 0, out, move), Placed::kExact);
  EXPECT_EQ(out, (Index3{1, -36, 0}));
  EXPECT_EQ(placement.place(batch_of(World3{8.3, 8, 8}), 0, out, move), Placed::kMoved);
  EXPECT_NEAR(move, 0.05, 1e-12);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {inf, -inf, std::nan("")})
    EXPECT_EQ(placement.place(batch_of(World3{0, bad, 0}), 0, out, move), Placed::kNotFinite);
  EXPECT_EQ(placement.place(batch_of(World3{0, 0, 1e300}), 0, out, move), Placed::kOutside);
}

TEST(Placement, RefusesIntegersThatWouldOverflow) {
  const Placement placement(grid(1024, 0), grid(0.001, 0));
  const Placement shifted(grid(0.001, 2e9), grid(0.001, 0));
  Index3 out{};
  double move = 0;
  EXPECT_EQ(placement.place(batch_of(Index3{2147483647, 0, 0}), 0, out, move), Placed::kOutside);
  EXPECT_EQ(shifted.place(batch_of(Index3{2147483647, 0, 0}), 0, out, move), Placed::kExact);
  const auto huge = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ(shifted.place(batch_of(Index3{huge, 0, 0}), 0, out, move), Placed::kOutside);
}

}  // namespace
}  // namespace pss
