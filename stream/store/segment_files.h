#pragma once
// The segments of a store, any number of them, of which only some are open at once.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/file/file.h"

namespace pss {

/// So many segments may a store have open: its share of the descriptors that the process has.
std::size_t most_open_segments();

/// Opens segments as they are read, and closes the one that was not read for the longest time.
///
/// A read that comes while all that may be open are being read opens its segment for itself.
/// Thread: any number at once.
class SegmentFiles {
 public:
  SegmentFiles(std::string store, std::size_t most_open);

  /// Takes a segment that is open already, where there is room. Requires: it is not kept yet.
  void keep(std::uint32_t segment, File file);
  /// Fills `out` from `offset` of a segment. Errors: those of File::open() and File::read().
  Result<void> read(std::uint32_t segment, std::uint64_t offset, std::span<std::byte> out);

 private:
  struct Slot {
    File file;
    std::uint32_t segment;
    std::size_t readers = 0;
    std::uint64_t last_use = 0;
  };
  Result<Slot*> acquire(std::uint32_t segment);
  void release(Slot& slot);
  Result<Slot*> open(std::uint32_t segment);
  Slot* place(std::uint32_t segment, File file);
  Slot* least_recent();
  Slot* find(std::uint32_t segment) const;
  bool room() const { return slots_.size() < most_open_; }
  std::string store_;
  std::size_t most_open_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::vector<Slot*> of_segment_;  ///< null where the segment is closed
  std::uint64_t uses_ = 0;
};

}  // namespace pss
