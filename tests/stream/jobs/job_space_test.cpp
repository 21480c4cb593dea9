#include "stream/jobs/job_space.h"

#include <gtest/gtest.h>

#include <vector>

namespace pss::test {
namespace {

const Lattice kCoarse{{0.01, 0.01, 0.01}, {0, 0, 0}};
const Lattice kFine{{0.01 / 256, 0.01 / 256, 0.01 / 256}, {0, 0, 0}};
const StoredPoints kMillion{1000000, 8000000, {kCoarse, 8}};

JobSpace space_to(const char* output, const std::vector<StoreShape>& passes) {
  JobRequest request;
  request.inputs = {"scan.las"};
  request.output = output;
  return job_space(request, kMillion, passes);
}

TEST(JobSpace, OfAResultCountsRefinedPositionsAndNewColumnsInFull) {
  const JobSpace space = space_to("out.las", {{kFine, 8 + 12}});

  EXPECT_EQ(space.sorted, 8000000u);
  EXPECT_EQ(space.passes, std::vector<std::uint64_t>{8000000 + 3 * 1000000 + 12 * 1000000});
  EXPECT_EQ(space.output, (12 + 20) * 1000000u);
}

TEST(JobSpace, OfAResultWithNarrowerRowsIsNoSmallerThanItsSource) {
  EXPECT_EQ(space_to("out.las", {{kCoarse, 8 - 7}}).passes, std::vector<std::uint64_t>{8000000});
}

TEST(JobSpace, OfColumnsAloneCountsNoPositionsAndTheOutputHasTheLastRows) {
  const JobSpace space = space_to("out.las", {{kCoarse, 12, true}, {kFine, 8}});

  EXPECT_EQ(space.passes, (std::vector<std::uint64_t>{12000000, 11000000}));
  EXPECT_EQ(space.output, (12 + 8) * 1000000u);
}

TEST(JobSpace, OfAStoreThatIsKeptHasNoOutput) {
  EXPECT_EQ(space_to("out.pss", {{kFine, 8}}).output, 0u);
}

TEST(JobSpace, IsLargestWhereSortingComputingOrWritingTakesMost) {
  const JobSpace sorting{100, {20}, 30, false};
  const JobSpace computing{100, {120, 130}, 30, false};
  const JobSpace writing{100, {110}, 200, false};

  EXPECT_EQ(sorting.most(), 200u) << "runs and the sorted input";
  EXPECT_EQ(computing.most(), 350u) << "the sorted input, normals and the result";
  EXPECT_EQ(writing.most(), 310u) << "the result and the output";
}

TEST(JobSpace, OfTheOutputIsFreedBySourcesUnlessTheyAreKept) {
  const JobSpace freed{100, {110}, 200, false};
  const JobSpace kept{100, {110}, 200, true};

  EXPECT_EQ(freed.most_more(true), 210u);
  EXPECT_EQ(kept.most_more(true), 310u);
  EXPECT_EQ(kept.most_more(false), 110u) << "the output goes to another disk";
}

}  // namespace
}  // namespace pss::test
