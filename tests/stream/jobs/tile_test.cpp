#include "stream/jobs/tile.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_value;

class Tile : public ::testing::Test {
 protected:
  Tile() {
    test::write_cloud(folder_ / "scan.las", test::sheet(3000, 4));
    job_.inputs = {folder_ / "scan.las"};
    job_.output = folder_ / "scan.pss";
    job_.state_folder = folder_ / "state";
    job_.tile_points = 1000;
  }
  Result<JobReport> run() {
    Monitor monitor;
    MemoryBudget budget(std::uint64_t{256} << 20, 1);
    return tile(job_, budget, monitor);
  }

  test::TemporaryDirectory folder_;
  TileJob job_;
};

TEST_F(Tile, LeavesTheStoreOfAllPointsAndNothingBesideIt) {
  const JobReport report = expect_value(run());

  const Store store = expect_value(Store::open(job_.output));
  EXPECT_TRUE(store.complete() && store.header().ordered);
  EXPECT_EQ(store.points(), 3000u);
  EXPECT_EQ(store.header().tile_points, 1000u);
  EXPECT_EQ(report.points_in, 3000u);
  EXPECT_EQ(report.points_out, 3000u);
  EXPECT_EQ(report.tiles, store.tiles().size());
  EXPECT_FALSE(exists(job_.work_directory()));
}

TEST_F(Tile, ReportsItsStagesInTheirOrder) {
  const auto json = nlohmann::json::parse(tile_json(expect_value(run())));

  std::vector<std::string> names;
  for (const auto& stage : json.at("stages")) names.push_back(stage.at("name"));
  EXPECT_EQ(names, (std::vector<std::string>{"plan", "sort", "write"}));
  EXPECT_EQ(json.at("command"), "tile");
  EXPECT_EQ(json.at("points_stored"), 3000);
}

TEST_F(Tile, KnowsItsStoreAgain) {
  expect_value(run());

  const JobReport again = expect_value(run());

  EXPECT_TRUE(again.already_complete);
  EXPECT_FALSE(nlohmann::json::parse(tile_json(again)).contains("points_stored"));
}

TEST_F(Tile, OfAnotherLatticeIsAnotherJob) {
  expect_value(run());
  job_.lattice_step = World3{0.5, 0.5, 0.5};

  EXPECT_FALSE(run()) << "the store of the first is in the way";
  job_.overwrite = true;
  const JobReport other = expect_value(run());

  EXPECT_FALSE(other.already_complete);
  EXPECT_EQ(expect_value(Store::open(job_.output)).header().lattice.scale, *job_.lattice_step);
}

TEST_F(Tile, RefusesAnOutputThatIsNoStoreAndAnInputThatIsOne) {
  expect_value(run());
  job_.output = folder_ / "scan2.las";
  const auto to_file = run();
  job_.inputs = {folder_ / "scan.pss"};
  job_.output = folder_ / "scan2.pss";
  const auto of_store = run();

  for (const auto& refused : {to_file, of_store}) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::kUsage);
  }
  EXPECT_FALSE(exists(folder_ / "scan2.las") || exists(folder_ / "scan2.pss"));
}

}  // namespace
}  // namespace pss
