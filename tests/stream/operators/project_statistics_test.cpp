#include "stream/operators/project_statistics.h"

#include <gtest/gtest.h>

namespace pss {
namespace {

Projection moved_point() {
  Projection projection;
  projection.status = Status::kOk;
  projection.neighbours = 10;
  projection.displacement = {3, 0, 4};
  projection.residual = 2;
  return projection;
}

TEST(ProjectStatistics, CountFlagsOverAllPointsAndShareTheRedoneAmongTheEvaluated) {
  Projection flagged = moved_point();
  flagged.second_sheet = true;
  flagged.redone = true;
  Projection excluded;
  excluded.status = Status::kExcluded;
  ProjectStatistics a, b;

  a.add(moved_point());
  a.add(flagged);
  b.add(flagged);
  b.add(moved_point());
  b.add(excluded);
  a.add(ProjectStatistics::from_bytes(b.to_bytes()));

  EXPECT_EQ(a.points(), 5u);
  EXPECT_EQ(a.moved(), 4u);
  EXPECT_EQ(a.second_sheet, 2u);
  EXPECT_EQ(a.redone, 2u);
  EXPECT_EQ(a.redone_share(), 0.5);
  EXPECT_EQ(a.rms_displacement(), 5);
  EXPECT_EQ(a.rms_residual(), 2);
  EXPECT_EQ(a.mean_neighbours(), 10);
}

TEST(ProjectStatistics, AreReadFromNotesOfTheirVersionAlone) {
  ProjectStatistics statistics;
  statistics.add(moved_point());
  const Note note{ProjectStatistics::kVersion, statistics.to_bytes()};
  const Note later{ProjectStatistics::kVersion + 1, note.bytes};

  const auto found = ProjectStatistics::from_note(note, "r.pss");
  const auto refused = ProjectStatistics::from_note(later, "r.pss");

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->points(), 1u);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().fault, Fault::kBadInput);
  EXPECT_EQ(ProjectStatistics::from_note({}, "r.pss")->points(), 0u);
}

TEST(ProjectStatistics, OfNothingAreZeroAndNeverNaN) {
  const ProjectStatistics none;

  EXPECT_EQ(none.redone_share(), 0);
  EXPECT_EQ(none.rms_displacement(), 0);
  EXPECT_EQ(ProjectStatistics::from_bytes({}).points(), 0u);
}

}  // namespace
}  // namespace pss
