// One bit flipped anywhere in what a job keeps: found and named, or without effect. Reliability
// test 6.

#include "stream/jobs/job_state.h"
#include "stream/store/export.h"
#include "stream/store/verify.h"
#include "tests/faults/small_job.h"
#include "tests/stream/store_fixture.h"

namespace pss::test {
namespace {

/// Every bit of small files would be millions: every step-th, each bit of a byte in turn.
constexpr std::uint64_t kBitStep = 61;  // prime to 8

bool names_a_place(const std::string& message, const std::string& file) {
  return message.find(file + ": damaged at offset ") != std::string::npos;
}

/// Calls `check(file, bit)` with one bit after the other flipped in files of a folder.
template <class Check>
void with_each_flipped(SimulatedDisk& disk, const std::string& folder, std::uint64_t step,
                       const Check& check) {
  for (const std::string& file : disk.files()) {
    if (!file.starts_with(folder)) continue;
    const std::uint64_t bits = 8 * disk.content(file).size();
    for (std::uint64_t bit = 0; bit < bits; bit += step) {
      SCOPED_TRACE(fmt::format("{} bit {} of byte {}", file, bit % 8, bit / 8));
      disk.flip_bit(file, bit);
      check(file);
      disk.flip_bit(file, bit);
      if (testing::Test::HasFailure()) return;
    }
  }
}

class BitFlip : public testing::Test {
 protected:
  BitFlip() {
    disk_.put(kScan, wavy_sheet(kSheet));
    const auto made = run(small_job(MlsOperator::kLevin, "/kept.pss"));
    EXPECT_TRUE(made) << made.error().message;
  }

  MemoryBudget budget_{std::uint64_t{256} << 20, 1};
  Monitor monitor_;
  SimulatedDisk disk_;
};

TEST_F(BitFlip, InAStoreIsFoundByVerifyWithFileAndOffset) {
  with_each_flipped(disk_, "/kept.pss/", stride(kBitStep), [&](const std::string& file) {
    const auto verified = verify_store("/kept.pss", budget_, monitor_);
    if (verified) {
      ASSERT_FALSE(verified->sound());
      EXPECT_TRUE(names_a_place(verified->damage[0], file)) << verified->damage[0];
    } else {
      EXPECT_EQ(verified.error().fault, Fault::kBadInput);
      EXPECT_TRUE(names_a_place(verified.error().message, file)) << verified.error().message;
    }
  });
}

TEST_F(BitFlip, InAStoreIsNamedByTheJobsThatReadIt) {
  ASSERT_TRUE(
      export_store(expect_value(Store::open("/kept.pss")), "/sound.ply", {}, budget_, monitor_));
  SmoothJob job = small_job();
  job.inputs = {"/kept.pss"};
  job.overwrite = job.restart = true;
  with_each_flipped(disk_, "/kept.pss/", stride(kBitStep * 8 + 1), [&](const std::string& file) {
    const auto store = Store::open("/kept.pss");
    const auto exported =
        store ? export_store(*store, "/copy.ply", {.rules = {.overwrite = true}}, budget_, monitor_)
              : Result<ExportSummary>(store.error());
    const auto smoothed = run(job);
    std::vector<Result<void>> results = {smoothed ? Result<void>() : smoothed.error()};
    if (exported && file == inputs_path("/kept.pss")) {  // of which it takes the first head alone
      ASSERT_TRUE(disk_.content("/copy.ply") == disk_.content("/sound.ply"));
      disk_.remove("/copy.ply");
    } else {
      results.push_back(exported ? Result<void>() : exported.error());
    }
    for (const Result<void>& result : results) {
      ASSERT_FALSE(result) << "read as if it were sound";
      EXPECT_EQ(result.error().fault, Fault::kBadInput) << result.error().message;
      EXPECT_TRUE(names_a_place(result.error().message, file)) << result.error().message;
    }
    EXPECT_FALSE(disk_.has("/copy.ply") || disk_.has(kOut));
  });
}

TEST_F(BitFlip, AMissingFileOfAStoreIsDamage) {
  for (const char* file : {"/kept.pss/segment-000000", "/kept.pss/inputs", "/kept.pss/manifest"}) {
    const auto bytes = disk_.content(file);
    disk_.remove(file);
    const auto verified = verify_store("/kept.pss", budget_, monitor_);
    ASSERT_FALSE(verified);
    EXPECT_EQ(verified.error().fault, Fault::kBadInput) << verified.error().message;
    EXPECT_NE(verified.error().message.find("/kept.pss"), std::string::npos);
    disk_.put(file, bytes);
  }
}

/// A job cut in a stage, then a bit flipped anywhere in its work directory.
/// What `info` tells of a damaged job: what is true, but for tiles whose record looks torn.
void expect_no_more_than(const JobState& state, const JobState& sound) {
  EXPECT_EQ(state.command, sound.command);
  EXPECT_EQ(state.output, sound.output);
  EXPECT_EQ(state.inputs, sound.inputs);
  EXPECT_EQ(state.parameters, sound.parameters);
  EXPECT_EQ(state.stage, sound.stage);
  EXPECT_LE(state.tiles_done, sound.tiles_done);
  EXPECT_EQ(state.tiles, sound.tiles);
  EXPECT_EQ(state.points, sound.points);
}

class FlipInJob : public testing::TestWithParam<int> {};

TEST_P(FlipInJob, IsNamedOrHasNoEffectOnTheResult) {
  const SmoothJob job = small_job(MlsOperator::kApss);
  const Undisturbed whole(job);
  const auto cut_job = [&](SimulatedDisk& disk) {
    disk.put(kScan, wavy_sheet(kSheet));
    disk.crash_before(whole.changes * static_cast<std::uint64_t>(GetParam()) / 100);
    EXPECT_FALSE(run(job));
    disk.restart(Crash::kKeep, 1);
  };
  std::vector<std::pair<std::string, std::uint64_t>> files;
  JobState sound;
  {
    SimulatedDisk disk;
    cut_job(disk);
    sound = expect_value(read_job_state("/out.ply.work"));
    for (const std::string& file : disk.files())
      if (file.starts_with("/out.ply.work/")) files.emplace_back(file, disk.content(file).size());
  }
  for (const auto& [file, size] : files)
    for (std::uint64_t bit = 3; bit < 8 * size; bit += stride(8 * size / 40 * 2 + 61)) {
      SCOPED_TRACE(fmt::format("{} bit {} of byte {}", file, bit % 8, bit / 8));
      SimulatedDisk disk;
      cut_job(disk);
      if (8 * disk.content(file).size() <= bit) continue;
      disk.flip_bit(file, bit);

      const auto state = read_job_state("/out.ply.work");
      const auto report = run(job);

      if (report) {
        ASSERT_TRUE(disk.content(kOut) == whole.result) << "wrong points";
      } else {
        ASSERT_TRUE(!disk.has(kOut) || disk.content(kOut) == whole.result);
        ASSERT_EQ(report.error().fault, Fault::kBadInput);
        ASSERT_TRUE(names_a_place(report.error().message, file)) << report.error().message;
      }
      if (state) {
        expect_no_more_than(*state, sound);
      } else {
        ASSERT_EQ(state.error().fault, Fault::kBadInput);
        ASSERT_TRUE(names_a_place(state.error().message, file)) << state.error().message;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Percent, FlipInJob, testing::Values(20, 45, 70, 92));

}  // namespace
}  // namespace pss::test
