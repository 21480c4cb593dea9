#include "stream/operators/project.h"

#include <gtest/gtest.h>

#include <atomic>

#include "core/parallel.h"
#include "stream/passes/part_needs.h"
#include "tests/stream/project_fixture.h"

namespace pss {
namespace {

using namespace test;

/// Stops when a tile is done and points of the next are.
class StopWithinSecondTile : public Monitor {
 public:
  void advance(std::uint64_t points, std::uint64_t tiles) override {
    if (tile_done_ && points > 0) stopping_ = true;
    if (tiles > 0) tile_done_ = true;
  }
  bool stopping() const override { return stopping_; }

 private:
  std::atomic<bool> tile_done_ = false;
  std::atomic<bool> stopping_ = false;
};

/// What the first tile takes as one part.
std::uint64_t bytes_of_first_tile(const Store& source, const ProjectParameters& parameters) {
  const ProjectOperator op = expect_value(ProjectOperator::create(source, parameters));
  const Source points(source);
  const PartLoader loader(points, op.needs());
  PartPlan plan = expect_value(loader.plan({0, 0, source.tiles()[0].blocks}));
  plan.around = op.neighbourhood().around(plan);
  expect_ok(loader.plan_near(plan, source.points()));
  return part_bytes(op, plan);
}

TEST(Project, EqualsTheSameComputationInMemory) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(1);
  const Store source = store_of(cloud, folder / "s.pss", {1000, 3000, 3001, 5000});
  const ProjectParameters parameters = fixed_support();
  const Cloud found = project(source, parameters, folder / "r.pss");
  std::vector<Index3> neighbours;
  for (std::size_t i = 0; i < kPoints; ++i)
    if (cloud.rows[i] == std::byte{0}) neighbours.push_back(cloud.positions[i]);
  const CellGrid grid(kLattice, neighbours, 4.9);
  Projector projector(grid, parameters.method);
  for (std::size_t i = 0; i < kPoints; ++i) {
    Index3 expected = cloud.positions[i];
    for (std::int64_t& c : expected) c *= 256;
    if (cloud.rows[i] == std::byte{0}) {
      const Query query{cloud.positions[i]};
      Projection p;
      projector.project({&query, 1}, {&parameters.support, 1}, {&p, 1});
      for (std::size_t a = 0; a < 3; ++a)
        expected[a] += std::llrint(p.displacement[a] / (0.001 / 256));
    }
    ASSERT_EQ(found.positions[i], expected) << i;
  }
}

TEST(Project, GivesTheSameRowsHoweverTilesAndPartsAreCut) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(2);
  for (const ProjectParameters& parameters : {fixed_support(), nearest_support()}) {
    const Store whole = store_of(cloud, folder / "whole.pss", {});
    const Cloud expected = project(whole, parameters, folder / "r.pss");

    const Store tiles = store_of(cloud, folder / "tiles.pss", {1, 100, 2000, 2001, 5000, 6999});
    expect_equal(project(tiles, parameters, folder / "r.pss"), expected);
    // A part that takes more than half of what is left is cut: here into the tile's two blocks.
    const std::uint64_t tight = limit_leaving(bytes_of_first_tile(whole, parameters));
    expect_equal(project(whole, parameters, folder / "r.pss", tight), expected);
    for (const int threads : {1, 2, 3}) {
      const ThreadLimit limit(threads);
      expect_equal(project(tiles, parameters, folder / "r.pss"), expected);
    }
  }
}

TEST(Project, AsksOncePerPlaceAndAnswersForAllItsPoints) {
  TemporaryDirectory folder;
  Cloud cloud = wave(8);
  for (std::size_t i = 0; i + 4 < kPoints; i += 5)  // runs of up to five points at one place
    for (std::size_t k = 1; k < 5; ++k) cloud.positions[i + k] = cloud.positions[i];
  const Store source = store_of(cloud, folder / "s.pss", {2500, 5000});

  const Cloud found = project(source, fixed_support(), folder / "r.pss");

  const std::size_t row = found.rows.size() / kPoints;
  std::size_t moved = 0;
  for (std::size_t i = 0; i + 1 < kPoints; ++i) {
    if (cloud.positions[i] != cloud.positions[i + 1]) continue;
    if (cloud.rows[i] != cloud.rows[i + 1]) continue;  // one of them is excluded
    ASSERT_EQ(found.positions[i], found.positions[i + 1]);
    ASSERT_TRUE(
        std::equal(&found.rows[i * row], &found.rows[(i + 1) * row], &found.rows[(i + 1) * row]));
    moved += found.positions[i][2] != cloud.positions[i][2] * 256;
  }
  EXPECT_GT(moved, kPoints / 2);
}

TEST(Project, NarrowsWhatABufferIsTooNarrowForSoThatTilesDoNotShow) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(9);
  const Store whole = store_of(cloud, folder / "whole.pss", {});
  const Store tiles = store_of(cloud, folder / "tiles.pss", {1, 100, 2000, 2001, 5000, 6999});
  for (ProjectParameters parameters : {fixed_support(), nearest_support()}) {
    parameters.buffer = 3.5;

    expect_equal(project(tiles, parameters, folder / "r.pss"),
                 project(whole, parameters, folder / "q.pss"));
  }
}

TEST(Narrowed, SupportsReachNoFartherThanTheWidth) {
  for (const WeightKind weight : kWeightKinds) {
    const Support wide{1, 3};
    EXPECT_EQ(narrowed(wide, weight, 4).radius, 3);
    for (const double width : {2.0, 1.2, 0.3}) {
      const Support narrow = narrowed(wide, weight, width);
      EXPECT_NEAR(reach(weight, narrow), width, 1e-12);
      EXPECT_LE(narrow.h, narrow.radius);
      EXPECT_GT(narrow.h, 0);
    }
  }
}

/// Every point three times: in key order, fewer places follow a point than it looks for.
Cloud thrice(const Cloud& cloud) {
  Cloud copies;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    for (int copy = 0; copy < 3; ++copy) {
      copies.positions.push_back(cloud.positions[i]);
      copies.rows.push_back(cloud.rows[i]);
    }
  return copies;
}

TEST(Project, WidensTheHaloUntilEveryKthNeighbourIsCertain) {
  TemporaryDirectory folder;
  const Store source = store_of(thrice(wave(3)), folder / "s.pss", {7500, 15000});
  ProjectParameters wide = nearest_support();
  wide.buffer = 9;  // holds what the cap allows: nothing is widened
  const Cloud expected = project(source, wide, folder / "wide.pss");
  const ProjectOperator op = expect_value(ProjectOperator::create(source, nearest_support()));
  StoreWriter writer = expect_value(StoreWriter::create(folder / "r.pss", op.result_header()));
  MemoryBudget budget(512 * kMiB, 1);
  Monitor monitor;

  const auto summary = expect_value(run_operator(Source(source), op, writer, budget, monitor));
  expect_ok(writer.finish("{}"));

  EXPECT_GT(summary.reloaded_parts, 0u);
  expect_equal(expect_value(read_all(expect_value(Store::open(folder / "r.pss")))), expected);
}

TEST(Project, GoesOnAfterAnInterruptionWithTheSameRows) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(4);
  const Store source = store_of(cloud, folder / "s.pss", {700, 2800, 3900, 5600});
  const ProjectOperator op = expect_value(ProjectOperator::create(source, fixed_support()));
  const Cloud expected = project(source, fixed_support(), folder / "whole.pss");
  MemoryBudget budget(512 * kMiB, 1);
  expect_value(StoreWriter::create(folder / "r.pss", op.result_header()));

  int interruptions = 0;
  for (bool done = false; !done;) {
    StopWithinSecondTile monitor;
    StoreWriter writer = expect_value(StoreWriter::resume(folder / "r.pss", op.result_header()));
    const auto summary = run_operator(Source(source), op, writer, budget, monitor);
    done = summary.has_value();
    if (done) {
      expect_ok(writer.finish("{}"));
    } else {
      ASSERT_EQ(summary.error().fault, Fault::kInterrupted);
      ++interruptions;
    }
  }

  EXPECT_EQ(interruptions, static_cast<int>(source.tiles().size()) - 1);
  expect_equal(expect_value(read_all(expect_value(Store::open(folder / "r.pss")))), expected);
}

TEST(Project, PassesOverEmptyTilesAndRecordsThem) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(4);
  const Cloud expected =
      project(store_of(cloud, folder / "s.pss", {2800}), fixed_support(), folder / "r.pss");
  const Store source = store_of(cloud, folder / "e.pss", {0, 2800, 2800, kPoints});
  ASSERT_EQ(source.tiles().size(), 5u);
  const ProjectOperator op = expect_value(ProjectOperator::create(source, fixed_support()));
  MemoryBudget budget(512 * kMiB, 1);
  Monitor monitor;
  EXPECT_EQ(expect_value(estimate_operator(Source(source), op, budget)).own_points, kPoints);
  {
    StoreWriter writer = expect_value(StoreWriter::create(folder / "r.pss", op.result_header()));
    expect_ok(writer.commit_tile(source.tiles()[0].cell, 0));
  }
  StoreWriter writer = expect_value(StoreWriter::resume(folder / "r.pss", op.result_header()));

  const auto summary = expect_value(run_operator(Source(source), op, writer, budget, monitor));
  expect_ok(writer.finish("{}"));

  EXPECT_EQ(summary.tiles, 4u);
  const Store result = expect_value(Store::open(folder / "r.pss"));
  ASSERT_EQ(result.tiles().size(), 5u);
  for (std::size_t t = 0; t < 5; ++t) {
    EXPECT_EQ(result.tiles()[t].source, t);
    EXPECT_EQ(result.tiles()[t].count, source.tiles()[t].count);
  }
  expect_equal(expect_value(read_all(result)), expected);
}

TEST(Project, RefusesWhatDoesNotFitWithPlaceAndLimit) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(5);
  const Store source = store_of(cloud, folder / "s.pss", {});
  ProjectParameters parameters = fixed_support();
  parameters.support = {30, 90};
  const ProjectOperator op = expect_value(ProjectOperator::create(source, parameters));
  StoreWriter writer = expect_value(StoreWriter::create(folder / "r.pss", op.result_header()));
  MemoryBudget budget(limit_leaving(kMiB / 4), 1);
  Monitor monitor;

  const auto summary = run_operator(Source(source), op, writer, budget, monitor);

  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().fault, Fault::kMemoryLimit);
  EXPECT_NE(summary.error().message.find("--memory-limit"), std::string::npos);
  EXPECT_NE(summary.error().message.find("4649"), std::string::npos) << "the place";
}

TEST(Project, LeavesExcludedPointsUnchangedAndOutOfEveryNeighbourhood) {
  TemporaryDirectory folder;
  Cloud cloud = wave(6);
  const Store with = store_of(cloud, folder / "with.pss", {3500});
  const Cloud smoothed = project(with, fixed_support(), folder / "r.pss");
  Cloud without;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (cloud.rows[i] != std::byte{0}) continue;
    without.positions.push_back(cloud.positions[i]);
    without.rows.push_back(cloud.rows[i]);
    kept.push_back(i);
  }

  const Cloud expected =
      project(store_of(without, folder / "without.pss", {}), fixed_support(), folder / "q.pss");

  const std::size_t row = smoothed.rows.size() / kPoints;
  for (std::size_t k = 0; k < kept.size(); ++k)
    ASSERT_EQ(smoothed.positions[kept[k]], expected.positions[k]);
  for (std::size_t i = 0; i < kPoints; i += 50) {
    EXPECT_EQ(smoothed.positions[i][0], cloud.positions[i][0] * 256);
    EXPECT_EQ(smoothed.rows[(i + 1) * row - 1],
              static_cast<std::byte>(Status::kExcluded));  // Status is the last attribute
  }
}

TEST(Project, KeepsAPointWhosePlaceTheOutputCannotHold) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(7);
  const Store source = store_of(cloud, folder / "s.pss", {});
  ProjectParameters parameters = fixed_support();
  // 2^31 steps of this grid end within the wave: places above do not fit.
  parameters.grid = Lattice{{1, 1, 1e-9}, {0, 0, 100 - 2.147483647}};

  const Cloud found = project(source, parameters, folder / "r.pss");

  std::size_t kept = 0;
  const std::size_t row = found.rows.size() / kPoints;
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (found.rows[(i + 1) * row - 1] != static_cast<std::byte>(Status::kNotRepresentable))
      continue;
    ++kept;
    EXPECT_EQ(found.positions[i][2], cloud.positions[i][2] * 256);
  }
  EXPECT_GT(kept, 300u);
}

TEST(RefinedLattice, KeepsPlacesAndLeavesRoomWithin42Bits) {
  IndexBox small;
  small.add(Index3{-1000, -1000, -1000});
  small.add(Index3{1000, 1000, 1000});
  IndexBox large;
  large.add(Index3{kLatticeMin / 4, 0, 0});

  EXPECT_EQ(refined_lattice(kLattice, small, 1).scale[0], 0.001 / 256);
  EXPECT_EQ(refined_lattice(kLattice, small, 1).origin, kLattice.origin);
  EXPECT_EQ(refined_lattice(kLattice, large, 1).scale[0], 0.001 / 2);
}

}  // namespace
}  // namespace pss
