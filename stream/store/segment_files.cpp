#include "stream/store/segment_files.h"

#include <algorithm>
#include <utility>

#include "stream/limit/descriptors.h"
#include "stream/store/manifest.h"

namespace pss {
namespace {

/// What else a process has open: inputs, logs, locks, sorted runs that are read in turn.
constexpr std::size_t kOtherFiles = 64;
/// A pass reads one store, perhaps a second, and a job may look into a third.
constexpr std::size_t kStoresAtOnce = 3;
constexpr std::size_t kFewest = 4;
/// More would be of no use: parts that are read at once lie in a few segments.
constexpr std::size_t kMost = 1024;

}  // namespace

std::size_t most_open_segments() {
  const std::size_t limit = descriptor_limit();
  const std::size_t left = limit - std::min(limit, kOtherFiles);
  return std::clamp(left / kStoresAtOnce, kFewest, kMost);
}

SegmentFiles::SegmentFiles(std::string store, std::size_t most_open)
    : store_(std::move(store)), most_open_(most_open) {}

SegmentFiles::Slot* SegmentFiles::find(std::uint32_t segment) const {
  return segment < of_segment_.size() ? of_segment_[segment] : nullptr;
}

/// The slot to take a segment's place in; none where all are being read.
SegmentFiles::Slot* SegmentFiles::least_recent() {
  Slot* found = nullptr;
  for (const auto& slot : slots_)
    if (slot->readers == 0 && (!found || slot->last_use < found->last_use)) found = slot.get();
  return found;
}

/// Requires: room, or a slot that nobody reads.
SegmentFiles::Slot* SegmentFiles::place(std::uint32_t segment, File file) {
  Slot* slot = room() ? nullptr : least_recent();
  if (slot) {
    of_segment_[slot->segment] = nullptr;
    *slot = {std::move(file), segment};
  } else {
    slot = slots_.emplace_back(std::make_unique<Slot>(Slot{std::move(file), segment})).get();
  }
  of_segment_.resize(std::max<std::size_t>(of_segment_.size(), segment + std::size_t{1}));
  return of_segment_[segment] = slot;
}

void SegmentFiles::keep(std::uint32_t segment, File file) {
  const std::lock_guard lock(mutex_);
  if (room()) place(segment, std::move(file));
}

/// Gives no slot where all are being read.
Result<SegmentFiles::Slot*> SegmentFiles::open(std::uint32_t segment) {
  if (!room() && !least_recent()) return static_cast<Slot*>(nullptr);
  PSS_ASSIGN(File file, File::open(segment_path(store_, segment)));
  return place(segment, std::move(file));
}

Result<SegmentFiles::Slot*> SegmentFiles::acquire(std::uint32_t segment) {
  const std::lock_guard lock(mutex_);
  Slot* slot = find(segment);
  if (!slot) {
    PSS_ASSIGN(slot, open(segment));
  }
  if (!slot) return slot;
  ++slot->readers;
  slot->last_use = ++uses_;
  return slot;
}

void SegmentFiles::release(Slot& slot) {
  const std::lock_guard lock(mutex_);
  --slot.readers;
}

Result<void> SegmentFiles::read(std::uint32_t segment, std::uint64_t offset,
                                std::span<std::byte> out) {
  PSS_ASSIGN(Slot* const slot, acquire(segment));
  if (!slot) {
    PSS_ASSIGN(const File file, File::open(segment_path(store_, segment)));
    return file.read(offset, out);
  }
  Result<void> done = slot->file.read(offset, out);
  release(*slot);
  return done;
}

}  // namespace pss
