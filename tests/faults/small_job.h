#pragma once
// A whole job small enough to be run thousands of times: a scan, sorted, projected, written.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "stream/jobs/smooth.h"
#include "tests/support/simulated_disk.h"

namespace pss::test {

/// Every how many calls one is tried: all of them by PSS_FAULT_STRIDE=1, in scripts/long.
inline std::uint64_t stride(std::uint64_t usual) {
  const char* text = std::getenv("PSS_FAULT_STRIDE");
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

inline const std::string kScan = "/scan.ply";
inline const std::string kOut = "/out.ply";
inline constexpr int kSheet = 34;

/// A wavy sheet of n x n points with a step of 1, in no order, as PLY text: a scan like any other.
inline std::vector<std::byte> wavy_sheet(int n) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nproperty uchar red\nend_header\n",
      n * n);
  for (int i = 0; i < n * n; ++i) {
    const int k = i * 7919 % (n * n);  // a prime: each point once
    const int x = k % n, y = k / n;
    const double z = (x * y % 7) * 0.05 + (x - n / 2) * (x - n / 2) * 0.01;
    text += fmt::format("{} {} {} {}\n", x, y, z, k % 200);
  }
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// A job of every kind of stage: `op` apss computes normals first, a store is kept, not written.
inline SmoothJob small_job(MlsOperator op = MlsOperator::kLevin, const std::string& output = kOut) {
  SmoothJob job;
  job.inputs = {kScan};
  job.output = output;
  job.options.op = op;
  job.tile_points = 200;
  job.state_folder = "/state/pss";
  job.options.widths.h = 1.0;
  job.options.widths.radius = 3.0;
  return job;
}

inline Result<SmoothReport> run(const SmoothJob& job) {
  Monitor monitor;
  MemoryBudget budget(std::uint64_t{256} << 20, 1);
  return smooth(job, budget, monitor);
}

/// What an undisturbed run of a job writes, and how much it does for that.
struct Undisturbed {
  std::vector<std::byte> result;
  std::uint64_t calls = 0, changes = 0, largest_use = 0;

  explicit Undisturbed(const SmoothJob& job) {
    SimulatedDisk disk;
    disk.put(kScan, wavy_sheet(kSheet));
    const auto report = run(job);
    EXPECT_TRUE(report) << report.error().message;
    result = disk.content(job.output);
    calls = disk.calls_made();
    changes = disk.changes_made();
    largest_use = disk.largest_use();
    EXPECT_FALSE(result.empty());
  }
};

/// The same command on what is left: it must end with the same bytes.
inline void expect_resumes(const SimulatedDisk& disk, const SmoothJob& job,
                           const Undisturbed& whole) {
  EXPECT_TRUE(!disk.has(job.output) || disk.content(job.output) == whole.result) << "half done";
  const auto report = run(job);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(disk.content(job.output) == whole.result) << "other bytes";
}

}  // namespace pss::test
