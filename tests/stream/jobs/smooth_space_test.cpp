#include "stream/jobs/smooth_space.h"

#include <gtest/gtest.h>

namespace pss::test {
namespace {

const Lattice kCoarse{{0.01, 0.01, 0.01}, {0, 0, 0}};
const Lattice kFine{{0.01 / 256, 0.01 / 256, 0.01 / 256}, {0, 0, 0}};
const StoredPoints kMillion{1000000, 8000000, kCoarse, 8};

SmoothJob job_to(const char* output) {
  SmoothJob job;
  job.inputs = {"scan.las"};
  job.output = output;
  return job;
}

TEST(SmoothSpace, OfAResultCountsRefinedPositionsAndNewColumnsInFull) {
  const SmoothSpace space =
      smooth_space(job_to("out.las"), NormalsFrom::kNowhere, kMillion, kFine, 8 + 12);

  EXPECT_EQ(space.sorted, 8000000u);
  EXPECT_EQ(space.result, 8000000u + 3 * 1000000u + 12 * 1000000u);
  EXPECT_EQ(space.output, (12 + 20) * 1000000u);
}

TEST(SmoothSpace, OfAResultWithNarrowerRowsIsNoSmallerThanItsSource) {
  const SmoothSpace space =
      smooth_space(job_to("out.las"), NormalsFrom::kNowhere, kMillion, kCoarse, 8 - 7);

  EXPECT_EQ(space.result, 8000000u);
}

TEST(SmoothSpace, OfAStoreThatIsKeptHasNoOutput) {
  EXPECT_EQ(smooth_space(job_to("out.pss"), NormalsFrom::kNowhere, kMillion, kFine, 8).output, 0u);
}

TEST(SmoothSpace, IsLargestWhereSortingComputingOrWritingTakesMost) {
  const SmoothSpace sorting{100, 0, 20, 30, false};
  const SmoothSpace computing{100, 120, 130, 30, false};
  const SmoothSpace writing{100, 0, 110, 200, false};

  EXPECT_EQ(sorting.most(), 200u) << "runs and the sorted input";
  EXPECT_EQ(computing.most(), 350u) << "the sorted input, normals and the result";
  EXPECT_EQ(writing.most(), 310u) << "the result and the output";
}

TEST(SmoothSpace, OfTheOutputIsFreedBySourcesUnlessTheyAreKept) {
  const SmoothSpace freed{100, 0, 110, 200, false};
  const SmoothSpace kept{100, 0, 110, 200, true};

  EXPECT_EQ(freed.most_more(true), 210u);
  EXPECT_EQ(kept.most_more(true), 310u);
  EXPECT_EQ(kept.most_more(false), 110u) << "the output goes to another disk";
}

}  // namespace
}  // namespace pss::test
