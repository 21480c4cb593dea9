#pragma once
// A job too large for its memory: runs, merges in two levels, tiles that share syncs, a file.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "stream/store/export.h"
#include "tests/stream/ingest_fixture.h"
#include "tests/support/simulated_disk.h"

namespace pss::test {

inline const std::string kPoints = "/points.las";
inline const std::string kSorted = "/sorted.las";

/// Counts how often each stage began.
class StageMonitor : public Monitor {
 public:
  void begin(std::string_view stage, std::uint64_t, std::uint64_t) override {
    ++begun[std::string(stage)];
  }
  std::map<std::string, int> begun;
};

/// The bytes of a scan: what a disk holds before the job.
inline std::vector<std::byte> points_file(std::size_t points) {
  SimulatedDisk disk;
  write_cloud(kPoints, sheet(points, 8));
  return disk.content(kPoints);
}

/// `early`: by how many bytes a file grows until it is synced beside its writer, in another thread,
/// so that the order of the calls is not always the same.
inline Result<void> sort_and_write(std::uint64_t early, Monitor& monitor) {
  constexpr std::uint64_t kTight = 3700 << 10;
  const ThreadLimit threads(1);  // they decide how much memory is left
  MemoryBudget budget = budget_of(kTight);
  IngestOptions options = small_tiles(1000);
  options.sync = {.early = early, .commit = 40000};
  PSS_ASSIGN(const IngestPlan plan, plan_ingest({kPoints}, options, monitor));
  PSS_TRY(ingest(plan, "/work/sorted.pss", "/work", options, budget, monitor));
  PSS_ASSIGN(const Store store, Store::open("/work/sorted.pss"));
  PSS_TRY(export_store(store, kSorted, {.rules = {.overwrite = true}}, budget, monitor));
  return {};
}

inline constexpr std::uint64_t kNever = std::uint64_t{1} << 40;

inline Result<void> sort_and_write(std::uint64_t early = kNever) {
  Monitor monitor;
  return sort_and_write(early, monitor);
}

}  // namespace pss::test
