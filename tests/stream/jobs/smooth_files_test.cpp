// Which files a job keeps in its work directory, and until when.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "io/convert.h"
#include "io/synth/synth.h"
#include "stream/jobs/job_state.h"
#include "stream/jobs/smooth.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_value;

/// Notes what is in the work directory when the writing begins.
class AtWriting : public Monitor {
 public:
  explicit AtWriting(std::string work_dir) : work_dir_(std::move(work_dir)) {}

  void begin(std::string_view stage, std::uint64_t, std::uint64_t) override {
    if (stage != "write") return;
    input_was_there = exists(work_dir_ + "/input.pss");
    normals_were_there = exists(work_dir_ + "/normals.pss");
    state = expect_value(read_job_state(work_dir_));
  }

  bool input_was_there = false;
  bool normals_were_there = false;
  JobState state;

 private:
  std::string work_dir_;
};

SmoothJob small_job(const test::TemporaryDirectory& folder) {
  SynthOptions options;
  options.points = 2000;
  const std::unique_ptr<Reader> scan = expect_value(SynthReader::create(options));
  Reader* const reader = scan.get();
  Monitor monitor;
  expect_value(copy_points({&reader, 1}, folder / "scan.las", {}, monitor));
  SmoothJob job;
  job.inputs = {folder / "scan.las"};
  job.output = folder / "out.las";
  job.options.op = MlsOperator::kApss;  // with a store of normals
  job.options.widths.h = 0.2;
  return job;
}

AtWriting run(const SmoothJob& job) {
  MemoryBudget budget(std::uint64_t{256} << 20, 1);
  AtWriting seen(job.output + ".work");
  expect_value(smooth(job, budget, seen));
  return seen;
}

TEST(SmoothFiles, TheSortedInputHasGoneWhenTheOutputIsWritten) {
  const test::TemporaryDirectory folder;
  const AtWriting seen = run(small_job(folder));

  EXPECT_FALSE(seen.input_was_there);
  EXPECT_FALSE(seen.normals_were_there);
}

TEST(SmoothFiles, TheStateOfAJobThatWritesSaysHowLargeItIs) {
  const test::TemporaryDirectory folder;
  const AtWriting seen = run(small_job(folder));

  EXPECT_EQ(seen.state.stage, "write");
  EXPECT_EQ(seen.state.points, 2000u);
  EXPECT_EQ(seen.state.tiles, seen.state.tiles_done);
}

TEST(SmoothFiles, AllStaysWhereTheWorkIsToBeKept) {
  const test::TemporaryDirectory folder;
  SmoothJob job = small_job(folder);
  job.keep_work = true;
  const AtWriting seen = run(job);

  EXPECT_TRUE(seen.input_was_there);
  EXPECT_TRUE(seen.normals_were_there);
  EXPECT_TRUE(exists(job.output + ".work/input.pss"));
}

}  // namespace
}  // namespace pss
