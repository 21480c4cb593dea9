// Power cuts and kills at every call of a whole job: reliability tests 1 and 3.

#include <random>

#include "tests/faults/small_job.h"

namespace pss::test {
namespace {

constexpr Crash kCrashes[] = {Crash::kKeep, Crash::kForget, Crash::kTear, Crash::kGarble};

struct Case {
  const char* name;
  MlsOperator op;
};

class CrashAt : public testing::TestWithParam<Case> {};

TEST_P(CrashAt, AnyChangeTheSameCommandEndsWithTheSameBytes) {
  const SmoothJob job = small_job(GetParam().op);
  const Undisturbed whole(job);
  const std::uint64_t step = stride(13);
  std::uint64_t crashes = 0;
  for (const Crash crash : kCrashes)
    for (std::uint64_t n = 1 + static_cast<std::uint64_t>(crash) % step; n <= whole.changes;
         n += step) {
      SCOPED_TRACE(fmt::format("crash {} before change {}", static_cast<int>(crash), n));
      SimulatedDisk disk;
      disk.put(kScan, wavy_sheet(kSheet));
      disk.crash_before(n);
      const auto cut = run(job);
      crashes += disk.crashed();
      ASSERT_TRUE(cut.has_value() || disk.crashed());

      disk.restart(crash, n);

      // The power may go while the last empty names are removed: all is done by then, and stays.
      ASSERT_TRUE(!cut || disk.content(kOut) == whole.result);

      expect_resumes(disk, job, whole);
      if (HasFailure()) return;
    }
  EXPECT_GT(crashes, 4 * whole.changes / step / 2);
  RecordProperty("crashes", std::to_string(crashes));
}

INSTANTIATE_TEST_SUITE_P(Jobs, CrashAt,
                         testing::Values(Case{"Levin", MlsOperator::kLevin},
                                         Case{"ApssWithNormals", MlsOperator::kApss}),
                         [](const auto& param) { return param.param.name; });

TEST(Crash, AgainAndAgainTheJobStillEndsWithTheSameBytes) {
  const SmoothJob job = small_job(MlsOperator::kApss);
  const Undisturbed whole(job);
  std::mt19937_64 random(5);
  for (int round = 0; round < 20; ++round) {
    SimulatedDisk disk;
    disk.put(kScan, wavy_sheet(kSheet));
    for (int crash = 0; crash < 12; ++crash) {
      disk.crash_before(1 + random() % (whole.changes / 3));
      (void)run(job);
      disk.restart(kCrashes[random() % 4], random());
    }
    expect_resumes(disk, job, whole);
    if (HasFailure()) return;
  }
}

TEST(Crash, WhatAFinishedTileCostIsNotPaidTwice) {
  const SmoothJob job = small_job();
  const Undisturbed whole(job);
  SimulatedDisk disk;
  disk.put(kScan, wavy_sheet(kSheet));
  disk.crash_before(whole.changes * 8 / 10);
  EXPECT_FALSE(run(job));

  disk.restart(Crash::kForget, 1);
  expect_resumes(disk, job, whole);

  EXPECT_LT(disk.changes_made(), whole.changes * 6 / 10);
}

TEST(Crash, ARestartWithOtherParametersNeverLeavesTheOldResult) {
  SmoothJob before = small_job();
  before.keep_work = true;
  SmoothJob job = small_job();
  job.options.widths.h = 0.8;
  const Undisturbed whole(job);
  job.restart = job.overwrite = true;
  SmoothJob again = job;
  again.restart = false;
  for (const Crash crash : kCrashes)
    for (std::uint64_t n = 1; n < 60; n += stride(3)) {
      SCOPED_TRACE(fmt::format("crash {} before change {}", static_cast<int>(crash), n));
      SimulatedDisk disk;
      disk.put(kScan, wavy_sheet(kSheet));
      ASSERT_TRUE(run(before));
      disk.crash_before(n);
      (void)run(job);
      disk.restart(crash, n);

      // Either the old job is still known, and named, or the new one goes on.
      const auto report = run(again);

      const bool named = !report && report.error().message.find("--h was") != std::string::npos;
      ASSERT_TRUE(named || report) << report.error().message;
      ASSERT_TRUE(named || disk.content(kOut) == whole.result) << "the old result";
    }
}

}  // namespace
}  // namespace pss::test
