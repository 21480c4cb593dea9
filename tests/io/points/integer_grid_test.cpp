#include "io/points/integer_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/named_numbers.h"

namespace pss::test {
namespace {

World3 triple(const std::vector<double>& v) {
  return v.size() == 1 ? World3{v[0], v[0], v[0]} : World3{v.at(0), v.at(1), v.at(2)};
}

WorldBox box_about(double middle, double side) {
  return {{middle - side, middle, 0}, {middle + side, middle + side / 3, 0}};
}

WorldBox widened(WorldBox bounds, double margin) {
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.min[a] -= margin;
    bounds.max[a] += margin;
  }
  return bounds;
}

TEST(IntegerGrid, ThatARefusalNamesHoldsAnyBounds) {
  for (const double side : {1e-9, 1.0, 1e6, 1e15, 1e30, 1e300})
    for (const double middle : {0.0, -3e6, 1e20}) {
      const WorldBox bounds = box_about(middle, side);
      Lattice grid{{1e-30, 1e-30, 1e-30}, {0, 0, 0}};
      const auto checked = check_integer_grid("a", grid, bounds, bounds);
      ASSERT_FALSE(checked) << side;

      const std::vector<double> scale = named_numbers(checked.error().message, "--scale");
      if (!scale.empty()) grid.scale = triple(scale);
      grid.origin = triple(named_numbers(checked.error().message, "--offset"));

      EXPECT_TRUE(integer_grid_holds(grid, bounds)) << checked.error().message;
    }
}

TEST(IntegerGrid, WithRoomIsTheFinestDecimalThatHoldsPointsThatMove) {
  for (const double side : {0.01, 1.0, 123456.0, 1e15})
    for (const double margin : {0.0, 0.5, 1e4}) {
      const WorldBox bounds = box_about(4100000.4, side);

      const Lattice grid = integer_grid_with_room(bounds, margin);

      EXPECT_TRUE(integer_grid_holds(grid, widened(bounds, margin))) << side << " " << margin;
      // A tenth would do only with steps that are kept free: 2^31 are there, 2 * 10^9 are used.
      Lattice finer = grid;
      for (double& scale : finer.scale) scale /= 10 * (0x1p31 / 2e9);
      EXPECT_FALSE(integer_grid_holds(finer, widened(bounds, margin))) << side << " " << margin;
      for (const double origin : grid.origin) EXPECT_EQ(origin, std::rint(origin));
    }
}

TEST(IntegerGrid, WithRoomOfNothingIsAboutZero) {
  const Lattice grid = integer_grid_with_room({}, 0);

  EXPECT_EQ(grid.origin, (World3{0, 0, 0}));
}

}  // namespace
}  // namespace pss::test
