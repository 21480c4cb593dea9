// Points so far away that the lattice would be too coarse for the others: refused by name, or left
// out and counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/formats/table.h"
#include "stream/sort/ingest.h"
#include "stream/store/export.h"
#include "tests/stream/ingest_fixture.h"
#include "tests/support/named_numbers.h"

namespace pss {
namespace {

using test::expect_value;
using test::ingest_files;
using test::write_text;

constexpr std::uint64_t kRoomy = std::uint64_t{64} << 20;

/// A flat grid of side x side points, one apart: the 16th nearest lies at sqrt(5), so that the
/// spacing is 0.9908.
std::string unit_grid(int side) {
  std::string text;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) text += std::to_string(x) + ' ' + std::to_string(y) + " 0\n";
  return text;
}

std::string point(double x, double y, double z) { return fmt::format("{} {} {}\n", x, y, z); }

WorldBox cube(double half) { return {{-half, -half, -half}, {half, half, half}}; }

class FarPoints : public testing::Test {
 protected:
  Result<IngestPlan> plan(const std::vector<std::string>& inputs,
                          const IngestOptions& options = {}) {
    Monitor monitor;
    return plan_ingest(inputs, options, monitor);
  }

  std::string refusal(const std::vector<std::string>& inputs, const IngestOptions& options = {}) {
    const auto found = plan(inputs, options);
    if (found.has_value()) return "accepted";
    EXPECT_EQ(found.error().fault, Fault::kBadInput);
    return found.error().message;
  }

  test::TemporaryDirectory folder_;
};

/// The box that a message names.
WorldBox named_box(const std::string& message) {
  const std::vector<double> box = test::named_numbers(message, "--drop-outside");
  EXPECT_EQ(box.size(), 6u) << message;
  const auto at = [&](std::size_t i) { return box.at(i - 1); };
  return {{at(1), at(2), at(3)}, {at(4), at(5), at(6)}};
}

TEST_F(FarPoints, AStepAboveAHundredthOfTheSpacingIsRefused) {
  // A side of 2^34 gives steps of 2^-7, a longer one steps of 2^-6. Of 60 x 60 points all are
  // sampled, of 141 x 141 the spacing is measured in a second reading.
  for (const int side : {60, 141}) {
    write_text(folder_ / "fine.xyz", unit_grid(side) + point(0, 0, 0x1p34));
    write_text(folder_ / "coarse.xyz", unit_grid(side) + point(0, 0, 0x1p34 + 1));

    EXPECT_TRUE(plan({folder_ / "fine.xyz"}).has_value());
    const std::string message = refusal({folder_ / "coarse.xyz"});

    EXPECT_NE(message.find("steps of 0.0156"), std::string::npos) << message;
    EXPECT_NE(message.find("spacing of 0.991"), std::string::npos) << message;
  }
}

TEST_F(FarPoints, FileRecordAndCoordinateAreNamed) {
  write_text(folder_ / "a.xyz", unit_grid(20));
  write_text(folder_ / "b.xyz", point(1, 2, 3) + point(1, -1e30, 3) + point(4, 5, 6));

  const std::string message = refusal({folder_ / "a.xyz", folder_ / "b.xyz"});

  EXPECT_NE(message.find("b.xyz: record 1: y = -1e+30"), std::string::npos) << message;
}

TEST_F(FarPoints, OneIsNamedAlsoWhereNoDoubleHoldsTheSide) {
  write_text(folder_ / "a.xyz", unit_grid(20) + point(1.7e308, 0, 0) + point(-1.7e308, 0, 0));

  const std::string message = refusal({folder_ / "a.xyz"});

  EXPECT_NE(message.find("record 400: x = 1.7e+308"), std::string::npos) << message;
}

TEST_F(FarPoints, FewPointsAreRefusedLikeMany) {
  write_text(folder_ / "a.xyz", point(0, 0, 0) + point(1, 0, 0) + point(0, 1e30, 0));

  EXPECT_NE(refusal({folder_ / "a.xyz"}).find("record 2: y"), std::string::npos);
}

TEST_F(FarPoints, TheNamedBoxMakesTheLatticeFineEnough) {
  const std::string middle = unit_grid(141);
  for (const double far : {1e12, -1e30, 3.4e38}) {
    write_text(folder_ / "a.xyz", middle + point(far, 3, 3));
    IngestOptions options;
    options.drop_outside = named_box(refusal({folder_ / "a.xyz"}));

    const auto without = expect_value(plan({folder_ / "a.xyz"}, options));

    const WorldBox bounds{{0, 0, 0}, {140, 140, 0}};
    EXPECT_EQ(without.header.lattice, lattice_for(bounds));
  }
}

TEST_F(FarPoints, AFineScanGetsTheLatticeOfItsBounds) {
  write_text(folder_ / "a.xyz", unit_grid(100) + point(5, 5, 1e6));

  const auto found = expect_value(plan({folder_ / "a.xyz"}));

  EXPECT_EQ(found.header.lattice, lattice_for({{0, 0, 0}, {99, 99, 1e6}}));
  EXPECT_EQ(found.header.parameters, "");
  EXPECT_NEAR(found.spacing, 0.991, 0.05);
}

TEST_F(FarPoints, PointsOutsideTheBoxAreLeftOutAndCountedApart) {
  write_text(folder_ / "a.xyz", "nan 0 0\n" + unit_grid(100) + point(1e30, 0, 0));
  write_text(folder_ / "b.xyz", point(0, 1e30, 0) + unit_grid(100) + point(0, 0, -1e9));
  write_text(folder_ / "c.xyz", unit_grid(100));
  IngestOptions options = test::small_tiles(1000);
  options.drop_outside = cube(1000);

  for (const std::uint64_t total : {kRoomy, std::uint64_t{6} << 20}) {
    const std::string name = std::to_string(total);
    const auto result =
        ingest_files(folder_, "s" + name, {folder_ / "a.xyz", folder_ / "b.xyz"}, options, total);
    const auto clean =
        ingest_files(folder_, "c" + name, {folder_ / "c.xyz", folder_ / "c.xyz"}, options, total);

    EXPECT_EQ(result.summary.points_read, 20004u);
    EXPECT_EQ(result.summary.points_stored, 20000u);
    EXPECT_EQ(result.summary.dropped_not_finite, 1u);
    EXPECT_EQ(result.summary.dropped_outside, 3u);
    EXPECT_EQ(result.verified.rows, clean.verified.rows);
  }
}

TEST_F(FarPoints, TheBoxHoldsForPositionsOnAGridToo) {
  const auto cloud = test::sheet(3000, 2);
  test::write_cloud(folder_ / "a.las", cloud);
  IngestOptions options;
  const Lattice grid = test::las_grid();
  options.drop_outside = WorldBox{to_world(grid, {0, 0, 0}), to_world(grid, {500, 500, 97})};
  std::uint64_t inside = 0;
  for (const Index3& p : cloud.positions)
    inside += options.drop_outside->contains(to_world(grid, p)) ? 1 : 0;

  const auto result = ingest_files(folder_, "s", {folder_ / "a.las"}, options, kRoomy);

  EXPECT_GT(inside, 900u);
  EXPECT_EQ(result.summary.points_stored, inside);
  EXPECT_EQ(result.summary.dropped_outside, 3000 - inside);
}

TEST_F(FarPoints, AnotherBoxIsAnotherJob) {
  write_text(folder_ / "a.xyz", unit_grid(10));
  IngestOptions options;
  options.drop_outside = cube(100);

  const auto found = expect_value(plan({folder_ / "a.xyz"}, options));

  EXPECT_EQ(found.header.parameters, R"({"drop-outside":[-100,-100,-100,100,100,100]})");
}

TEST_F(FarPoints, ALasOutputAsksForMoreThanTheLattice) {
  // Steps of 2^-14 do for the lattice; int32 holds a side of 10^8 in steps of 0.1.
  write_text(folder_ / "a.xyz", unit_grid(60) + point(0, 0, 1e8));
  IngestOptions options;
  EXPECT_TRUE(plan({folder_ / "a.xyz"}, options).has_value());
  options.gridded_output.emplace();

  const std::string message = refusal({folder_ / "a.xyz"}, options);

  EXPECT_NE(message.find("record 3600: z = 100000000 "), std::string::npos) << message;
  options.drop_outside = named_box(message);
  EXPECT_TRUE(plan({folder_ / "a.xyz"}, options).has_value());
}

TEST_F(FarPoints, AScaleThatIsChosenAnewForLasIsLookedAtToo) {
  // A hundredth of 0.2 is above the scale 0.001, which holds the first file, and below 0.01.
  test::Cloud cloud;
  for (std::int64_t i = 0; i < 1000; ++i)
    cloud.positions.push_back({i % 40 * 200, i / 40 * 200, 0});
  cloud.positions.push_back({0, 0, 2000000000});
  cloud.rows.resize(cloud.positions.size() * test::las_schema().row_size());
  test::write_cloud(folder_ / "a.las", cloud, {{0.001, 0.001, 0.001}, {0, 0, 0}});
  test::write_cloud(folder_ / "b.las", cloud, {{0.001, 0.001, 0.001}, {0, 0, 3e6}});
  IngestOptions options;
  options.gridded_output.emplace();
  options.gridded_output->scale_auto = true;

  EXPECT_TRUE(plan({folder_ / "a.las"}, options).has_value());
  const std::string message = refusal({folder_ / "a.las", folder_ / "b.las"}, options);

  EXPECT_NE(message.find("b.las: record 1000: z = 5000000 "), std::string::npos) << message;
}

TEST_F(FarPoints, AScaleByHandThatCannotHoldThePointsIsRefusedByThePlan) {
  write_text(folder_ / "a.xyz", unit_grid(60));
  test::write_cloud(folder_ / "b.las", test::sheet(1000, 1));
  IngestOptions options;
  options.gridded_output.emplace();
  options.gridded_output->scale = World3{1e-9, 1e-9, 1e-9};

  for (const char* name : {"a.xyz", "b.las"}) {
    const std::string message = refusal({folder_ / name}, options);
    EXPECT_NE(message.find("do not fit into 32-bit integers"), std::string::npos) << message;
    EXPECT_NE(message.find("use --scale="), std::string::npos) << message;
  }
}

TEST_F(FarPoints, OfAStoreAreNamedByTheirRowWhicheverTileTheyAreIn) {
  write_text(folder_ / "a.xyz", unit_grid(60) + point(0, 0, 1e8));
  ingest_files(folder_, "s", {folder_ / "a.xyz"}, test::small_tiles(500), kRoomy);
  const Store store = expect_value(Store::open(folder_ / "s.pss"));
  ASSERT_GT(store.tiles().size(), 4u);
  Monitor monitor;

  const auto refused = check_export(store, 0, kLasFormat, {}, monitor);

  // The highest by far is the last in key order.
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find(fmt::format("record {}:", store.points() - 1)),
            std::string::npos)
      << refused.error().message;
}

TEST_F(FarPoints, AStoreIsCheckedBeforeItIsExported) {
  write_text(folder_ / "a.xyz", unit_grid(60) + point(0, 0, 1e8));
  ingest_files(folder_, "s", {folder_ / "a.xyz"}, {}, kRoomy);
  const Store store = expect_value(Store::open(folder_ / "s.pss"));
  Monitor monitor;

  const auto chosen = check_export(store, 0, kLasFormat, {}, monitor);
  const auto by_hand =
      check_export(store, 0, kLasFormat, {.scale = World3{0.2, 0.2, 0.2}}, monitor);
  const auto ply = check_export(store, 0, kPlyFormat, {}, monitor);

  ASSERT_FALSE(chosen.has_value());
  EXPECT_NE(chosen.error().message.find("z = 100000000 "), std::string::npos)
      << chosen.error().message;
  EXPECT_NE(expect_value(by_hand).find("a tenth of the points' spacing"), std::string::npos);
  EXPECT_EQ(expect_value(ply), "");
}

}  // namespace
}  // namespace pss
