#include "stream/operators/query_batch.h"

#include <gtest/gtest.h>

#include "tests/support/cloud.h"

namespace pss::test {
namespace {

const Lattice kLattice{{0.001, 0.001, 0.001}, {0, 0, 0}};
constexpr Support kSupport{0.1, 0.3};

/// A noisy sheet over the unit square.
std::vector<Index3> sheet() {
  Random random(17);
  std::vector<World3> world;
  for (int i = 0; i < 2000; ++i)
    world.push_back({random.uniform(0, 1), random.uniform(0, 1), 0.02 * random.normal()});
  return on_lattice_sorted(kLattice, world);
}

TEST(QueryBatch, KnowsTheAnswerForMorePointsOfItsLastPlaceWithoutAskingAgain) {
  const std::vector<Index3> points = sheet();
  const CellGrid grid(kLattice, points, 0.3);
  Projector projector(grid, Method());
  QueryBatch batch;
  for (std::size_t i = 0; i < 10; ++i) batch.add(points[i], kSupport);
  batch.project(projector);
  const Projection last = batch.answer(9);
  ASSERT_EQ(last.status, Status::kOk);

  batch.clear();
  batch.add(Status::kExcluded);
  batch.add(points[9], kSupport);

  EXPECT_EQ(batch.answer(0).status, Status::kExcluded);
  EXPECT_EQ(batch.answer(1).displacement, last.displacement);
}

TEST(QueryBatch, AnswersOtherPlacesAfterTheLastAsIfTheyWereAlone) {
  const std::vector<Index3> points = sheet();
  const CellGrid grid(kLattice, points, 0.3);
  Projector projector(grid, Method());
  QueryBatch alone, batch;
  alone.add(points[700], kSupport);
  alone.project(projector);

  batch.add(points[500], kSupport);
  batch.project(projector);
  batch.clear();
  batch.add(points[500], kSupport);
  batch.add(points[700], kSupport);
  batch.project(projector);
  batch.clear();
  batch.add(points[500], kSupport);
  batch.add(points[700], kSupport);
  batch.project(projector);

  EXPECT_NE(batch.answer(0).displacement, batch.answer(1).displacement);
  EXPECT_EQ(batch.answer(1).displacement, alone.answer(0).displacement);
}

}  // namespace
}  // namespace pss::test
