#include "stream/sort/ingest.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <string>

#include "core/parallel.h"
#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_value;
using test::ingest_files;
using test::small_tiles;

constexpr std::uint64_t kRoomy = 256 << 20;

void expect_equal(const test::Cloud& found, const test::Cloud& expected) {
  EXPECT_TRUE(found.positions == expected.positions);
  EXPECT_TRUE(found.rows == expected.rows);
}

TEST(Ingest, SortsPointsAndRowsAsStdSortDoes) {
  test::TemporaryDirectory folder;
  const auto cloud = test::sheet(30000, 1);
  test::write_cloud(folder / "a.las", cloud);

  const auto result = ingest_files(folder, "s", {folder / "a.las"}, small_tiles(4000), kRoomy);

  expect_equal(result.cloud, test::sorted(cloud));
  EXPECT_EQ(result.summary.points_read, 30000u);
  EXPECT_EQ(result.summary.points_stored, 30000u);
  EXPECT_EQ(result.summary.moved_to_lattice, 0u);
}

TEST(Ingest, KeepsScaleOffsetAndHeaderOfASingleFile) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "a.las", test::sheet(100, 1));
  Monitor monitor;

  const auto plan = expect_value(plan_ingest({folder / "a.las"}, {}, monitor));

  EXPECT_EQ(plan.header.lattice, test::las_grid());
  EXPECT_EQ(plan.header.grid, test::las_grid());
  EXPECT_EQ(plan.points, 100u);
  EXPECT_EQ(plan.inputs.at(0).path, folder / "a.las");
  EXPECT_EQ(plan.header.inputs, digest_of(plan.inputs));
}

/// Budgets for 40,000 points of 16 bytes: in memory, two runs, half a dozen runs.
constexpr std::uint64_t kBudgets[] = {kRoomy, 4500 << 10, 3800 << 10};

TEST(Ingest, MakesTheSameStoreWhateverBudgetThreadsAndInputOrder) {
  test::TemporaryDirectory folder;
  const auto cloud = test::sheet(40000, 2);
  const auto mixed = test::shuffled(cloud, 9);
  test::write_cloud(folder / "a.las", cloud);
  test::write_cloud(folder / "b1.las", test::slice(mixed, 0, 25000));
  test::write_cloud(folder / "b2.las", test::slice(mixed, 25000, 40000));
  const auto whole = ingest_files(folder, "w", {folder / "a.las"}, small_tiles(1000), kRoomy);
  int n = 0;
  for (const std::uint64_t budget : kBudgets)
    for (const int threads : {1, 2})
      for (const bool split : {false, true}) {
        const ThreadLimit limit(threads);
        const std::vector<std::string> inputs =
            split ? std::vector{folder / "b2.las", folder / "b1.las"}
                  : std::vector{folder / "a.las"};

        const auto result =
            ingest_files(folder, fmt::format("s{}", n++), inputs, small_tiles(1000), budget);

        EXPECT_EQ(result.verified.rows, whole.verified.rows) << budget << " " << threads;
        ASSERT_EQ(result.tiles.size(), whole.tiles.size());
        for (std::size_t t = 0; t < whole.tiles.size(); ++t)
          EXPECT_EQ(result.tiles[t].index_hash, whole.tiles[t].index_hash);
      }
}

/// Counts how often each stage began.
class StageMonitor : public Monitor {
 public:
  void begin(std::string_view stage, std::uint64_t, std::uint64_t) override {
    ++begun[std::string(stage)];
  }
  std::map<std::string, int> begun;
};

TEST(Ingest, MergesInSeveralLevelsWhereTheLimitIsTiny) {
  const ThreadLimit threads(2);
  test::TemporaryDirectory folder;
  const auto cloud = test::sheet(120000, 8);
  test::write_cloud(folder / "a.las", cloud);
  const IngestOptions options = small_tiles(1000);
  StageMonitor monitor;
  MemoryBudget budget = test::budget_of(3760 << 10);
  const auto plan = expect_value(plan_ingest({folder / "a.las"}, options, monitor));

  const auto summary =
      expect_value(ingest(plan, folder / "s.pss", folder / "work", options, budget, monitor));

  EXPECT_GE(monitor.begun["merge runs"], 1);
  EXPECT_EQ(summary.points_stored, 120000u);
  const Store store = expect_value(Store::open(folder / "s.pss"));
  expect_equal(expect_value(test::read_all(store)), test::sorted(cloud));
}

TEST(Ingest, HashesTheSameRowsWhateverTheTileSize) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "a.las", test::sheet(20000, 4));
  const auto whole = ingest_files(folder, "w", {folder / "a.las"}, {}, kRoomy);
  for (const std::uint32_t most : {10u, 333u, 5000u}) {
    const auto result = ingest_files(folder, fmt::format("s{}", most), {folder / "a.las"},
                                     small_tiles(most), kRoomy);
    EXPECT_EQ(result.verified.rows, whole.verified.rows);
    EXPECT_GT(result.tiles.size(), whole.tiles.size());
  }
}

TEST(Ingest, PutsAMillionCopiesOfOnePointIntoTilesOfOneCell) {
  test::TemporaryDirectory folder;
  test::Cloud cloud;
  cloud.positions.assign(1000000, {1, 2, 3});
  cloud.rows.assign(cloud.positions.size() * test::las_schema().row_size(), std::byte{0});
  test::write_cloud(folder / "a.las", cloud);

  const auto result = ingest_files(folder, "s", {folder / "a.las"}, {}, 16 << 20);

  ASSERT_EQ(result.tiles.size(), 4u);
  for (const TileInfo& tile : result.tiles) EXPECT_EQ(tile.cell.level, kLatticeBits);
  EXPECT_EQ(result.tiles[2].count, kTilePoints);
  EXPECT_EQ(result.cloud.positions, cloud.positions);
}

TEST(Ingest, StoresOnePointAndNone) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "one.las", test::sheet(1, 1));
  test::write_cloud(folder / "none.las", test::sheet(0, 1));

  const auto one = ingest_files(folder, "one", {folder / "one.las"}, {}, kRoomy);
  const auto none = ingest_files(folder, "none", {folder / "none.las"}, {}, kRoomy);

  ASSERT_EQ(one.tiles.size(), 1u);
  EXPECT_EQ(one.tiles[0].cell.level, 0);
  EXPECT_EQ(none.summary.points_stored, 0u);
  EXPECT_TRUE(none.tiles.empty());
}

TEST(Ingest, SharesOneLatticeAmongAlignedFiles) {
  test::TemporaryDirectory folder;
  const auto cloud = test::sheet(2000, 5);
  auto moved = test::slice(cloud, 1000, 2000);
  for (Index3& p : moved.positions) p[0] -= 10000;  // the other file's offset is 100 m further on
  test::write_cloud(folder / "a.las", test::slice(cloud, 0, 1000));
  test::write_cloud(folder / "b.las", moved, {{0.01, 0.01, 0.01}, {500100, 4100000, 0}});

  const auto result = ingest_files(folder, "s", {folder / "b.las", folder / "a.las"}, {}, kRoomy);

  expect_equal(result.cloud, test::sorted(cloud));
  EXPECT_EQ(result.summary.moved_to_lattice, 0u);
}

TEST(Ingest, MovesFilesThatDoNotAlignByAtMostHalfAStepAndSaysSo) {
  test::TemporaryDirectory folder;
  const auto cloud = test::sheet(500, 6);
  test::write_cloud(folder / "a.las", cloud, {{0.01, 0.01, 0.01}, {0, 0, 0}});
  test::write_cloud(folder / "b.las", cloud, {{0.01, 0.01, 0.01}, {0.003, 0, 0}});
  Monitor monitor;

  const auto plan = expect_value(plan_ingest({folder / "a.las", folder / "b.las"}, {}, monitor));
  const auto result = ingest_files(folder, "s", {folder / "a.las", folder / "b.las"}, {}, kRoomy);

  ASSERT_EQ(plan.notes.size(), 1u);
  EXPECT_NE(plan.notes[0].find("b.las"), std::string::npos);
  EXPECT_EQ(result.summary.moved_to_lattice, 500u);
  EXPECT_NEAR(result.summary.largest_move, 0.003, 1e-9);
  EXPECT_EQ(result.summary.points_stored, 1000u);
}

TEST(Ingest, GivesFloatsALatticeOfTheirBounds) {
  test::TemporaryDirectory folder;
  test::write_text(folder / "a.xyz", "0 0 0\n3 0.5 0\n1.5 -0.25 1\n");

  const auto result = ingest_files(folder, "s", {folder / "a.xyz"}, {}, kRoomy);

  const Store store = expect_value(Store::open(folder / "s.pss"));
  EXPECT_EQ(store.header().lattice.scale, (World3{0x1p-39, 0x1p-39, 0x1p-39}));
  EXPECT_EQ(result.summary.moved_to_lattice, 0u);
  std::vector<World3> found;
  for (const Index3& p : result.cloud.positions)
    found.push_back(to_world(store.header().lattice, p));
  std::ranges::sort(found);
  EXPECT_EQ(found, (std::vector<World3>{{0, 0, 0}, {1.5, -0.25, 1}, {3, 0.5, 0}}));
}

TEST(Ingest, TakesTheStepByHand) {
  test::TemporaryDirectory folder;
  test::write_text(folder / "a.xyz", "0 0 0\n3 0.5 0\n1.52 -0.25 1\n");
  IngestOptions options;
  options.scale = World3{0.25, 0.25, 0.25};

  const auto result = ingest_files(folder, "s", {folder / "a.xyz"}, options, kRoomy);

  EXPECT_EQ(result.summary.moved_to_lattice, 1u);
  EXPECT_NEAR(result.summary.largest_move, 0.02, 1e-9);
}

TEST(Ingest, MixesFilesWithAndWithoutGrid) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "a.las", test::sheet(100, 5), {{0.25, 0.25, 0.25}, {0, 0, 0}});
  test::write_text(folder / "b.xyz", "0.125 7 7\n100 100 100\n");

  const auto result = ingest_files(folder, "s", {folder / "a.las", folder / "b.xyz"}, {}, kRoomy);

  EXPECT_EQ(result.summary.points_stored, 102u);
  EXPECT_EQ(result.summary.moved_to_lattice, 0u);
}

std::string ply_with(const std::vector<std::array<float, 3>>& points) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(points.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  text.append(reinterpret_cast<const char*>(points.data()), points.size() * 12);
  return text;
}

TEST(Ingest, DropsPositionsThatAreNotFiniteAndCountsThem) {
  test::TemporaryDirectory folder;
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  test::write_text(folder / "a.ply",
                   ply_with({{1, 2, 3}, {nan, 0, 0}, {4, 5, 6}, {0, 0, -inf}, {7, 8, 9}}));

  const auto result = ingest_files(folder, "s", {folder / "a.ply"}, {}, kRoomy);

  EXPECT_EQ(result.summary.points_read, 5u);
  EXPECT_EQ(result.summary.dropped_not_finite, 2u);
  EXPECT_EQ(result.cloud.positions.size(), 3u);
}

TEST(Ingest, KeepsAllPointsBesideThoseThatItDropsInEveryBatch) {
  test::TemporaryDirectory folder;
  const ThreadLimit threads(2);
  std::string finite = "0 0 0\n30000 30000 0\n";
  std::string all = finite;
  for (int i = 1; i < 30000; ++i) {
    const std::string line = std::to_string(i * 7919 % 30000) + ' ' + std::to_string(i) + " 1\n";
    finite += line;
    all += i % 7 == 0 ? "nan 1 1\n" + line : line;
  }
  test::write_text(folder / "a.xyz", all);
  test::write_text(folder / "b.xyz", finite);

  const auto result = ingest_files(folder, "a", {folder / "a.xyz"}, {}, kRoomy);
  const auto expected = ingest_files(folder, "b", {folder / "b.xyz"}, {}, kRoomy);

  EXPECT_EQ(result.summary.dropped_not_finite, 4285u);
  EXPECT_EQ(result.summary.points_stored, 30001u);
  expect_equal(result.cloud, expected.cloud);
}

TEST(Ingest, ReportsTheSameCountsFromACompleteStore) {
  test::TemporaryDirectory folder;
  test::write_text(folder / "a.xyz", "0 0 0\nnan 1 1\n0.1 0.2 0.3\n");
  const auto first = ingest_files(folder, "s", {folder / "a.xyz"}, {}, kRoomy);

  const auto again = ingest_files(folder, "s", {folder / "a.xyz"}, {}, kRoomy);

  EXPECT_EQ(again.summary.points_read, first.summary.points_read);
  EXPECT_EQ(again.summary.dropped_not_finite, 1u);
  EXPECT_EQ(again.summary.largest_move, first.summary.largest_move);
}

TEST(Ingest, AddsWhereEachPointCameFrom) {
  test::TemporaryDirectory folder;
  const auto cloud = test::sheet(3000, 7);
  test::write_cloud(folder / "a.las", test::slice(cloud, 0, 1000));
  test::write_cloud(folder / "b.las", test::slice(cloud, 1000, 3000));
  IngestOptions options = small_tiles(500);
  options.source_column = true;

  const auto result =
      ingest_files(folder, "s", {folder / "a.las", folder / "b.las"}, options, 6 << 20);

  const Store store = expect_value(Store::open(folder / "s.pss"));
  const auto file = store.header().schema.dimension("SourceFile");
  const auto record = store.header().schema.dimension("SourceRecord");
  ASSERT_TRUE(file && record);
  const std::size_t row = store.header().schema.row_size();
  for (std::size_t i = 0; i < result.cloud.positions.size(); ++i) {
    const std::byte* r = result.cloud.rows.data() + i * row;
    const auto source =
        static_cast<std::size_t>(1000 * read_value(*file, r) + read_value(*record, r));
    ASSERT_EQ(result.cloud.positions[i], cloud.positions[source]);
  }
}

TEST(Ingest, RefusesWhatFitsNoLatticeWithTheScaleThatWould) {
  test::TemporaryDirectory folder;
  test::write_text(folder / "a.xyz", "0 0 0\n1e6 1e6 1e6\n");
  IngestOptions options;
  options.scale = World3{1e-9, 1e-9, 1e-9};
  Monitor monitor;

  const auto plan = plan_ingest({folder / "a.xyz"}, options, monitor);

  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().fault, Fault::kBadInput);
  EXPECT_NE(plan.error().message.find("--scale 2.4e-07"), std::string::npos)
      << plan.error().message;
}

TEST(Ingest, NamesTheLimitThatWouldDo) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "a.las", test::sheet(100, 1));
  Monitor monitor;
  MemoryBudget budget = test::budget_of(1 << 20);
  const auto plan = expect_value(plan_ingest({folder / "a.las"}, {}, monitor));

  const auto result = ingest(plan, folder / "s.pss", folder / "work", {}, budget, monitor);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().fault, Fault::kMemoryLimit);
  EXPECT_NE(result.error().message.find("--memory-limit"), std::string::npos);
}

TEST(Ingest, RefusesAFullDiskBeforeItFillsIt) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "a.las", test::sheet(5000, 1));
  Monitor monitor;
  MemoryBudget budget = test::budget_of(std::uint64_t{64} << 30);
  auto plan = expect_value(plan_ingest({folder / "a.las"}, {}, monitor));
  plan.points = std::uint64_t{1} << 40;

  const auto result = ingest(plan, folder / "s.pss", folder / "work", {}, budget, monitor);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().fault, Fault::kFailed);
  EXPECT_NE(result.error().message.find("disk is too full"), std::string::npos);
}

}  // namespace
}  // namespace pss
