// Crashes, failures and flipped bits while runs are written, merged in levels, cut into tiles and
// written as a file: reliability tests 1, 3, 4 and 6 of what small jobs never do.

#include <cerrno>
#include <random>

#include "tests/faults/small_job.h"
#include "tests/faults/sorting_job.h"

namespace pss::test {
namespace {

constexpr Crash kCrashes[] = {Crash::kKeep, Crash::kForget, Crash::kTear, Crash::kGarble};

class Merge : public testing::Test {
 protected:
  Merge() : points_(points_file(90000)) {
    SimulatedDisk disk;
    disk.put(kPoints, points_);
    disk.set_fault([&](Call call, const std::string& path) {
      if (call == Call::kSync && path == "/work/runs/log")
        log_syncs_.push_back(disk.changes_made());
      return 0;
    });
    StageMonitor monitor;
    const auto done = sort_and_write(kNever, monitor);
    EXPECT_TRUE(done) << done.error().message;
    EXPECT_GE(monitor.begun["merge runs"], 1);
    EXPECT_EQ(monitor.begun["merge"], 1);
    expected_ = disk.content(kSorted);
    changes_ = disk.changes_made();
    calls_ = disk.calls_made();
  }

  /// The same again on what is left ends with the same bytes.
  void expect_finishes(const SimulatedDisk& disk, std::uint64_t early = kNever) {
    EXPECT_TRUE(!disk.has(kSorted) || disk.content(kSorted) == expected_) << "half done";
    const auto done = sort_and_write(early);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_TRUE(disk.content(kSorted) == expected_) << "other bytes";
  }

  /// What is in the work directory when the process dies before change `n`.
  std::map<std::string, std::vector<std::byte>> left_by_a_kill(std::uint64_t n) const {
    SimulatedDisk disk;
    disk.put(kPoints, points_);
    disk.crash_before(n);
    EXPECT_FALSE(sort_and_write());
    std::map<std::string, std::vector<std::byte>> left;
    for (const std::string& file : disk.files())
      if (file.starts_with("/work/")) left[file] = disk.content(file);
    return left;
  }

  std::vector<std::byte> points_, expected_;
  std::vector<std::uint64_t> log_syncs_;
  std::uint64_t changes_ = 0, calls_ = 0;
};

TEST_F(Merge, CutAtAnyChangeEndsWithTheSameBytes) {
  for (const std::uint64_t early : {kNever, std::uint64_t{20000}})
    for (const Crash crash : kCrashes)
      for (std::uint64_t n = 1 + static_cast<std::uint64_t>(crash); n <= changes_;
           n += stride(131)) {
        SCOPED_TRACE(fmt::format("crash {} before change {}", static_cast<int>(crash), n));
        SimulatedDisk disk;
        disk.put(kPoints, points_);
        disk.crash_before(n);
        ASSERT_FALSE(sort_and_write(early));

        disk.restart(crash, n);

        expect_finishes(disk, early);
        if (HasFailure()) return;
      }
}

TEST_F(Merge, KilledAndThenWithoutPowerEndsWithTheSameBytes) {
  // What a killed process had not synced is there when the next one begins, and not durable yet.
  for (const std::uint64_t n : log_syncs_)
    for (std::uint64_t later = 2; later <= 8; ++later) {
      SCOPED_TRACE(fmt::format("killed before change {}, cut before change {}", n, later));
      SimulatedDisk disk;
      disk.put(kPoints, points_);
      disk.crash_before(n);
      ASSERT_FALSE(sort_and_write());
      disk.restart(Crash::kKeep, n);
      disk.crash_before(later);
      static_cast<void>(sort_and_write());

      disk.restart(Crash::kTear, n + later);

      expect_finishes(disk);
      if (HasFailure()) return;
    }
}

TEST_F(Merge, AFailedCallIsOneMessageAndResumable) {
  for (const std::uint64_t early : {kNever, std::uint64_t{20000}})
    for (std::uint64_t n = 1; n <= calls_; n += stride(211)) {
      SCOPED_TRACE(fmt::format("EIO at call {}", n));
      SimulatedDisk disk;
      disk.put(kPoints, points_);
      disk.set_fault([seen = std::uint64_t{0}, n](Call, const std::string&) mutable {
        return ++seen == n ? EIO : 0;
      });

      const auto done = sort_and_write(early);

      if (done) {
        ASSERT_TRUE(disk.content(kSorted) == expected_);
      } else {
        ASSERT_EQ(done.error().fault, Fault::kFailed) << done.error().message;
        ASSERT_TRUE(done.error().message.starts_with("/")) << done.error().message;
      }
      disk.restart(Crash::kForget, n);
      expect_finishes(disk, early);
      if (HasFailure()) return;
    }
}

TEST_F(Merge, AFlippedBitIsNamedOrHasNoEffect) {
  for (const std::uint64_t percent : {30, 60, 75, 90}) {
    const auto left = left_by_a_kill(changes_ * percent / 100);
    ASSERT_GT(left.size(), 1u);
    for (const auto& [file, bytes] : left) {
      const std::uint64_t bits = 8 * bytes.size();
      for (std::uint64_t bit = 3; bit < bits; bit += bits / (160 / stride(80)) / 2 * 2 + 61) {
        SCOPED_TRACE(fmt::format("{} bit {} of byte {}", file, bit % 8, bit / 8));
        SimulatedDisk disk;
        disk.put(kPoints, points_);
        for (const auto& [name, content] : left) disk.put(name, content);
        disk.flip_bit(file, bit);

        const auto done = sort_and_write();

        if (done) {
          ASSERT_TRUE(disk.content(kSorted) == expected_) << "wrong points";
        } else {
          ASSERT_EQ(done.error().fault, Fault::kBadInput) << done.error().message;
          ASSERT_NE(done.error().message.find(file + ": damaged at offset "), std::string::npos)
              << done.error().message;
        }
      }
    }
  }
}

}  // namespace
}  // namespace pss::test
