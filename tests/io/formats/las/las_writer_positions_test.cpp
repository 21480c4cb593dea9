// Positions in the LAS writer: scale and offset, rounding, what does not fit.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "tests/io/formats/las/las_writer_fixture.h"

namespace pss::test {
namespace {

TEST_F(LasWriterTest, WithoutAHeaderChoosesTheLeastFormatAndNoClock) {
  WriteOptions options;
  options.schema = Schema({field("Red", Type::kUint16), field("Quality", Type::kFloat32)});
  options.count = 1;
  options.bounds = WorldBox{{500000, 0, -10}, {501000, 1, 10}};
  PointBatch points;
  points.world = {{500123.456789, 0.123456789, -9.87654321}};
  points.rows.resize(6);

  const std::string out = write(options, points);

  EXPECT_EQ(out[25], 2);
  EXPECT_EQ(out[104], 2);
  EXPECT_EQ(get<std::uint16_t>(out, 105), 26 + 4);
  EXPECT_EQ(get<std::uint32_t>(out, 90), 0u);
  read(out);
  // 10^9 steps hold half a side: 500 in 10^-6, 0.5 in 10^-9, 10 in 10^-8.
  EXPECT_EQ(header_.grid->scale, (World3{1e-6, 1e-9, 1e-8}));
  const World3 p = to_world(*header_.grid, points_.index[0]);
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(p[a], points.world[0][a], 0.51 * header_.grid->scale[a]);
  EXPECT_EQ(header_.schema.dimension("Quality")->type, Type::kFloat32);
}

TEST_F(LasWriterTest, RoundsOtherPositionsOnceToTheNearest) {
  read(las({.points = 1}));  // scale 0.01, offset 0, 1000, 2000
  WriteOptions options = carried();
  options.grid.reset();
  points_.index.clear();
  points_.world = {{0.0149, 999.984, 2000.016}};

  read(write(options, points_));

  EXPECT_EQ(points_.index[0], (Index3{1, -2, 2}));
}

TEST_F(LasWriterTest, RefusesPositionsThatDoNotFitNamingPointAndLimits) {
  read(las({.points = 2}));
  WriteOptions options = carried();
  for (const std::int64_t index :
       {std::int64_t{2147483648}, std::int64_t{-2147483649}, INT64_MIN}) {
    points_.index[1][2] = index;
    const auto done = try_write(options, points_);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().fault, Fault::kBadInput);
    EXPECT_NE(done.error().message.find("point 1: found z = "), std::string::npos);
    EXPECT_NE(done.error().message.find("21476836.47"), std::string::npos) << done.error().message;
  }
  options.grid.reset();
  points_.index.clear();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {kNan, HUGE_VAL, -HUGE_VAL, 21474836.476, -21474836.49, 1e300}) {
    points_.world = {{0, 0, 0}, {x, 0, 0}};
    EXPECT_NE(write(options, points_).find("point 1: found x = "), std::string::npos) << x;
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
}

TEST_F(LasWriterTest, TakesScaleAndOffsetOfTheOptions) {
  read(las({.points = 2}));
  WriteOptions options = carried();
  options.scale = World3{0.001, 0.001, 0.001};

  read(write(options, points_));

  EXPECT_EQ(header_.grid, (Lattice{{0.001, 0.001, 0.001}, {0, 1000, 2000}}));
  EXPECT_EQ(points_.index[1], (Index3{1000, -1000, 10}));
}

TEST_F(LasWriterTest, MovesTheOffsetWhereAFinerScaleDoesNotReach) {
  read(las({.points = 2}));
  WriteOptions options = carried();
  options.carry.reset();
  options.grid = Lattice{{0.01, 0.01, 0.01}, {0, 0, 0}};
  options.bounds = WorldBox{{5000000, 0, 0}, {5000100, 1, 1}};
  options.scale = World3{0.0001, 0.0001, 0.0001};
  points_.index = {{500000000, 0, 0}, {500010000, 100, 100}};

  read(write(options, points_));

  EXPECT_NEAR(to_world(*header_.grid, points_.index[1])[0], 5000100, 1e-5);
}

TEST_F(LasWriterTest, RefusesAScaleThatIsNone) {
  read(las({.points = 1}));
  for (const double scale : {0.0, -1.0, HUGE_VAL}) {
    WriteOptions options = carried();
    options.scale = World3{0.01, scale, 0.01};
    const auto done = try_write(options, points_);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().fault, Fault::kUsage);
  }
}

}  // namespace
}  // namespace pss::test
