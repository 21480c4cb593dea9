#pragma once
// A disk in memory that stands in for io/file/disk_posix.cpp: what a crash does to it can be
// chosen.
//
// The model: a file's bytes are durable after its sync, a directory's names after the sync of that
// directory; until then a crash may do anything to them that crash() can. What was synced stays,
// also beside bytes that were being written; a rename happens wholly or not at all.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/file/disk.h"

namespace pss::test {

enum class Crash {
  kKeep,    ///< the process dies, the machine does not: everything written is there
  kForget,  ///< nothing is there that was not synced
  kTear,    ///< any part of it: blocks and names in any order, any size in between
  kGarble,  ///< all names, and rubbish where bytes were written
};

enum class Call {
  kOpen,
  kRead,
  kWrite,
  kTruncate,
  kSync,
  kLock,
  kStatus,
  kList,
  kMakeDirectory,
  kRemoveDirectory,
  kRemoveFile,
  kRename,
  kSyncDirectory,
  kFreeSpace
};

/// Whether a call changes, or makes durable, what is on the disk.
bool changes(Call call);
const char* name_of(Call call);

/// What happens at a call: nothing (0), an errno, or kShort, which halves a read or a write.
inline constexpr int kShort = -1;
using FaultAt = std::function<int(Call call, const std::string& path)>;

/// The disk that io/file/disk.h leads to in this program; one at a time.
///
/// Thread: calls of io/file/disk.h may come from any thread, those of this class from one.
class SimulatedDisk {
 public:
  SimulatedDisk();
  ~SimulatedDisk();
  SimulatedDisk(const SimulatedDisk&) = delete;
  SimulatedDisk& operator=(const SimulatedDisk&) = delete;

  /// Every call is shown to `fault` first, which decides about it.
  void set_fault(FaultAt fault);
  /// The power goes before the n-th call (from 1) that changes something: from then on every call
  /// fails and nothing happens, until restart().
  void crash_before(std::uint64_t n);
  bool crashed() const;
  /// The n-th sync (from 1) of a file or a directory from now on says yes and does nothing.
  void lie_at(std::uint64_t n);
  /// What that sync was of: "sync /a", "sync directory /"; "" before it.
  const std::string& lied_about() const;
  /// What is left after a crash, or after the process was killed; `seed` chooses for kTear.
  void restart(Crash crash, std::uint64_t seed);

  /// Calls that change something so far; all calls so far.
  std::uint64_t changes_made() const;
  std::uint64_t calls_made() const;
  /// At most so many bytes in all files: ENOSPC beyond.
  void set_capacity(std::uint64_t bytes);
  std::uint64_t largest_use() const;

  // Straight to the content, past every fault; what is put is durable, its folders too.
  void put(const std::string& path, std::span<const std::byte> bytes);
  std::vector<std::string> files() const;
  bool has(const std::string& path) const;
  std::vector<std::byte> content(const std::string& path) const;
  void flip_bit(const std::string& path, std::uint64_t bit);
  void remove(const std::string& path);

  struct State;

 private:
  State* state_;
};

}  // namespace pss::test
