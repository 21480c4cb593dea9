// That every sync is needed: a disk that skips one and says yes loses something at some crash, or
// the sync is one of a short list. Shows, too, that the crash tests would find a missing sync.

#include <algorithm>
#include <map>

#include "tests/faults/small_job.h"

namespace pss::test {
namespace {

/// Syncs without which a crash costs work, but no byte: so many of each may be without effect.
std::map<std::string, int> harmless_syncs() {
  std::map<std::string, int> syncs = {
      // A name that is lost, of a folder, a log or a record: what it named is begun again.
      // Of the lock's name, after which a temporary may stay; of the state folder's name.
      {"sync directory /", 3},
      // Three of them while the directory is removed: what comes back is removed by the next run.
      {"sync directory /out.ply.work", 12},
      {"sync directory /out.ply.work/runs", 1},
      // Of a table's first record, which the sync of the whole table covers.
      {"sync /out.ply.work/input.pss/inputs.new", 1},
  };
  for (const char* store : {"input", "normals", "smooth"}) {
    // The name of the log; its second name, which says no more than the end record in it.
    syncs[fmt::format("sync directory /out.ply.work/{}.pss", store)] = 2;
    // Of the tiles, whose records the sync of the end record covers, too.
    syncs[fmt::format("sync /out.ply.work/{}.pss/manifest.log", store)] = 1;
  }
  return syncs;
}

struct Sync {
  std::string about;         ///< call and path
  std::uint64_t change = 0;  ///< its number among those that change something
};

/// The syncs of a job, in their order.
std::vector<Sync> syncs_of(const SmoothJob& job) {
  std::vector<Sync> syncs;
  SimulatedDisk disk;
  disk.put(kScan, wavy_sheet(kSheet));
  disk.set_fault([&](Call call, const std::string& path) {
    if (call == Call::kSync || call == Call::kSyncDirectory)
      syncs.push_back({fmt::format("{} {}", name_of(call), path), disk.changes_made()});
    return 0;
  });
  EXPECT_TRUE(run(job));
  return syncs;
}

/// Whether the job, cut before change `n`, ends otherwise than it should when sync `k` (from 1)
/// did nothing.
bool shows(const SmoothJob& job, const Undisturbed& whole, std::uint64_t k, std::uint64_t n,
           Crash crash) {
  SimulatedDisk disk;
  disk.put(kScan, wavy_sheet(kSheet));
  disk.lie_at(k);
  disk.crash_before(n);
  const bool done = run(job).has_value();
  disk.restart(crash, n);
  if (done && disk.content(kOut) != whole.result) return true;  // it said that all is there
  return !run(job) || disk.content(kOut) != whole.result;
}

/// The same at the crashes around later syncs (the next ones; all in the long form), and after the
/// end.
bool shows_somewhere(const SmoothJob& job, const Undisturbed& whole, const std::vector<Sync>& syncs,
                     std::size_t k) {
  std::vector<std::uint64_t> cuts;
  const std::size_t end = stride(4) == 1 ? syncs.size() : std::min(syncs.size(), k + 4);
  for (std::size_t later = k; later < end; ++later) {
    if (later > k) cuts.push_back(syncs[later].change);
    cuts.push_back(syncs[later].change + 1);
  }
  cuts.push_back(whole.changes + 1);
  for (const std::uint64_t n : cuts)
    for (const Crash crash : {Crash::kForget, Crash::kGarble})
      if (shows(job, whole, k + 1, n, crash)) return true;
  return false;
}

TEST(Sync, IsMissedByTheCrashTestsOrOneOfAShortList) {
  const SmoothJob job = small_job(MlsOperator::kApss);
  const Undisturbed whole(job);
  const std::vector<Sync> syncs = syncs_of(job);
  auto harmless = harmless_syncs();
  int needed = 0;
  for (std::size_t k = 0; k < syncs.size(); ++k) {
    if (shows_somewhere(job, whole, syncs, k))
      ++needed;
    else
      EXPECT_GE(--harmless[syncs[k].about], 0) << syncs[k].about << ", sync " << k + 1;
  }
  RecordProperty("needed", needed);
  RecordProperty("syncs", static_cast<int>(syncs.size()));
  EXPECT_GE(needed, 19);
}

}  // namespace
}  // namespace pss::test
