#include "stream/sort.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <vector>

#include "core/parallel.h"
#include "stream/keyed_rows.h"

namespace pss {
namespace {

constexpr int kDigitBits = 10;
constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
/// Ranges this short are sorted by comparison.
constexpr std::size_t kSmall = 512;
/// Ranges this long are split before they are handed to the threads.
constexpr std::size_t kLarge = 1 << 16;

using Entries = std::span<SortEntry>;

/// A range to sort, and its equal share of the scratch.
struct Part {
  Entries entries, scratch;
};

/// The rank of the highest bit in which keys of the range differ, or -1; a word has 63 bits.
int highest_difference(Entries entries) {
  Key differ;
  for (const SortEntry& e : entries) {
    differ.high |= e.key.high ^ entries[0].key.high;
    differ.low |= e.key.low ^ entries[0].key.low;
  }
  if (differ.high != 0) return 63 + static_cast<int>(std::bit_width(differ.high)) - 1;
  return static_cast<int>(std::bit_width(differ.low)) - 1;
}

/// The kDigitBits bits of the key from `shift` up.
std::size_t digit(const Key& key, int shift) {
  const std::uint64_t bits = shift >= 63
                                 ? key.high >> (shift - 63)
                                 : (key.low >> shift) | (shift > 0 ? key.high << (63 - shift) : 0);
  return static_cast<std::size_t>(bits) & (kBuckets - 1);
}

using Starts = std::array<std::size_t, kBuckets + 1>;

/// Orders the range by its leading differing bits; bucket b is [starts[b], starts[b + 1]).
Starts scatter(const Part& part, int highest) {
  const int shift = std::max(0, highest + 1 - kDigitBits);
  Starts starts{};
  for (const SortEntry& e : part.entries) ++starts[digit(e.key, shift) + 1];
  for (std::size_t b = 0; b < kBuckets; ++b) starts[b + 1] += starts[b];
  Starts next = starts;
  for (const SortEntry& e : part.entries) part.scratch[next[digit(e.key, shift)]++] = e;
  std::ranges::copy(part.scratch, part.entries.begin());
  return starts;
}

class Sorter {
 public:
  Sorter(const std::byte* rows, std::size_t row_size, const Monitor& monitor)
      : rows_(rows), row_size_(row_size), monitor_(monitor) {}

  void sort(const Part& part) const {
    if (part.entries.size() <= kSmall) return sort_small(part.entries);
    if (stopping()) return;
    const int highest = highest_difference(part.entries);
    if (highest < 0) return sort_small(part.entries);
    for_each_bucket(part, highest, [&](const Part& bucket) { sort(bucket); });
  }

  /// Splits long ranges by one thread until the rest is worth sharing out.
  void split(const Part& part, std::vector<Part>& ready) const {
    const int highest = part.entries.size() > kLarge ? highest_difference(part.entries) : -1;
    if (highest < 0 || stopping()) return ready.push_back(part);
    for_each_bucket(part, highest, [&](const Part& bucket) { split(bucket, ready); });
  }

  bool stopped() const { return stopped_; }

 private:
  /// Once stopping, always stopping: a range that was left unsorted must not be taken for sorted.
  bool stopping() const {
    if (monitor_.stopping()) stopped_ = true;
    return stopped_;
  }

  template <class Body>
  void for_each_bucket(const Part& part, int highest, const Body& body) const {
    const Starts starts = scatter(part, highest);
    for (std::size_t b = 0; b < kBuckets; ++b) {
      const std::size_t count = starts[b + 1] - starts[b];
      if (count > 1)
        body(Part{part.entries.subspan(starts[b], count), part.scratch.subspan(starts[b], count)});
    }
  }

  void sort_small(Entries entries) const {
    std::ranges::sort(entries, [&](const SortEntry& a, const SortEntry& b) {
      return before(a.key, row(a), b.key, row(b), row_size_);
    });
  }

  const std::byte* row(const SortEntry& e) const { return rows_ + e.row * row_size_; }

  const std::byte* rows_;
  std::size_t row_size_;
  const Monitor& monitor_;
  mutable std::atomic<bool> stopped_{false};
};

}  // namespace

bool sort_entries(std::span<SortEntry> entries, std::span<SortEntry> scratch, const std::byte* rows,
                  std::size_t row_size, const Monitor& monitor) {
  assert(scratch.size() == entries.size());
  const Sorter sorter(rows, row_size, monitor);
  std::vector<Part> parts;
  sorter.split({entries, scratch}, parts);
  parallel_for(parts.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sorter.sort(parts[i]);
  });
  return !sorter.stopped();
}

}  // namespace pss
