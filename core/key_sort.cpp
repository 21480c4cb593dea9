#include "core/key_sort.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <vector>

#include "core/parallel.h"

namespace pss {
namespace {

using Entries = std::span<KeyEntry>;

/// Ranges this short are sorted by insertion.
constexpr std::size_t kSmall = 24;
/// Ranges longer than this are split by all threads together.
constexpr std::size_t kLarge = 1 << 16;
/// More buckets than these write to too many places at once for the caches.
constexpr int kMostDigitBits = 11;
constexpr std::size_t kMostBuckets = std::size_t{1} << kMostDigitBits;
constexpr std::size_t kScanGrain = 1 << 15;

using Starts = std::array<std::uint32_t, kMostBuckets + 1>;

/// The bits by which a range is split.
struct Digit {
  int shift = 0;
  int width = 0;

  std::size_t buckets() const { return std::size_t{1} << width; }
  std::size_t operator()(std::uint64_t bits) const { return (bits >> shift) & (buckets() - 1); }
};

/// From the highest bit that differs down, so many that about eight entries share a bucket.
Digit digit_for(std::size_t count, int highest) {
  const int width =
      std::min({static_cast<int>(std::bit_width(count / 4)) - 1, kMostDigitBits, highest + 1});
  return {highest + 1 - width, width};
}

/// 64 bits of a key above its lowest `shift`, 0 to 62; a word of a key has 63.
std::uint64_t window(const Key& key, int shift) {
  return (key.low >> shift) | (key.high << (63 - shift));
}

/// The rank of the highest bit set, or -1.
int highest_bit(std::uint64_t bits) { return static_cast<int>(std::bit_width(bits)) - 1; }

int highest_bit(const Key& bits) {
  return bits.high != 0 ? 63 + highest_bit(bits.high) : highest_bit(bits.low);
}

std::uint64_t difference(std::span<const KeyEntry> entries, std::uint64_t from) {
  std::uint64_t differ = 0;
  for (const KeyEntry& e : entries) differ |= e.bits ^ from;
  return differ;
}

std::uint64_t difference_in_parallel(std::span<const KeyEntry> entries) {
  std::atomic<std::uint64_t> differ = 0;
  parallel_for(entries.size(), kScanGrain, [&](std::size_t begin, std::size_t end) {
    differ |= difference(entries.subspan(begin, end - begin), entries[0].bits);
  });
  return differ;
}

/// What all keys together are like.
struct Survey {
  Key differ;  ///< bits that are not the same in all
  bool sorted = true;
};

Survey survey(std::span<const Key> keys) {
  std::atomic<std::uint64_t> high = 0, low = 0;
  std::atomic<bool> sorted = true;
  parallel_for(keys.size(), kScanGrain, [&](std::size_t begin, std::size_t end) {
    Key differ;
    bool in_order = begin == 0 || keys[begin - 1] <= keys[begin];
    for (std::size_t i = begin; i < end; ++i) {
      differ.high |= keys[i].high ^ keys[0].high;
      differ.low |= keys[i].low ^ keys[0].low;
    }
    for (std::size_t i = begin + 1; i < end && in_order; ++i) in_order = keys[i - 1] <= keys[i];
    high |= differ.high;
    low |= differ.low;
    if (!in_order) sorted = false;
  });
  return {{high, low}, sorted};
}

/// Puts entry `get(i)` of `count` into its bucket in `out`; bucket b is [starts[b], starts[b + 1]).
/// Each thread has its slices, and each slice its own place in every bucket.
template <class Get>
std::vector<std::uint32_t> scatter_in_parallel(std::size_t count, const Get& get,
                                               const Digit& digit, Entries out) {
  const std::size_t slices = 2 * static_cast<std::size_t>(thread_count());
  const std::size_t buckets = digit.buckets();
  const auto slice_begin = [&](std::size_t s) { return count * s / slices; };
  std::vector<std::uint32_t> places(slices * buckets);
  parallel_for(slices, 1, [&](std::size_t s, std::size_t) {
    std::uint32_t* const counts = &places[s * buckets];
    for (std::size_t i = slice_begin(s); i < slice_begin(s + 1); ++i) ++counts[digit(get(i).bits)];
  });
  std::vector<std::uint32_t> starts(buckets + 1);
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b < buckets; ++b) {
    starts[b] = sum;
    for (std::size_t s = 0; s < slices; ++s) {
      const std::uint32_t n = places[s * buckets + b];
      places[s * buckets + b] = sum;
      sum += n;
    }
  }
  starts[buckets] = sum;
  parallel_for(slices, 1, [&](std::size_t s, std::size_t) {
    std::uint32_t* const next = &places[s * buckets];
    for (std::size_t i = slice_begin(s); i < slice_begin(s + 1); ++i) {
      const KeyEntry e = get(i);
      out[next[digit(e.bits)]++] = e;
    }
  });
  return starts;
}

/// The same by one thread, without a heap.
void scatter(std::span<const KeyEntry> in, const Digit& digit, Entries out, Starts& starts) {
  const std::size_t buckets = digit.buckets();
  std::fill_n(starts.begin(), buckets + 1, 0);
  for (const KeyEntry& e : in) ++starts[digit(e.bits)];
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b < buckets; ++b) sum = starts[b] += sum;
  // From the back, each bucket's end moves down to its begin.
  for (std::size_t i = in.size(); i-- > 0;) out[--starts[digit(in[i].bits)]] = in[i];
  starts[buckets] = sum;
}

/// A range to sort, which lies in one of two buffers, and the same range of the other.
struct Part {
  Entries here, there;
  bool home = true;    ///< `here` is where the result belongs
  bool exact = false;  ///< keys of equal `bits` are equal
};

class Sorter {
 public:
  Sorter(std::span<const Key> keys, const TieBreak& tie, const Monitor& monitor)
      : keys_(keys), tie_(tie), monitor_(monitor) {}

  void run(Entries entries, Entries scratch) {
    const Survey all = survey(keys_);
    if (all.sorted) return take_as_they_are(entries);
    const int highest = highest_bit(all.differ);
    const int shift = std::max(0, highest - 63);
    const auto entry = [&](std::size_t i) {
      return KeyEntry{window(keys_[i], shift), static_cast<std::uint32_t>(i)};
    };
    if (keys_.size() <= kLarge) {
      for (std::size_t i = 0; i < keys_.size(); ++i) entries[i] = entry(i);
      return sort({entries, scratch, true, shift == 0});
    }
    const Digit digit = digit_for(keys_.size(), highest - shift);
    std::vector<Part> ready;
    split({entries, scratch, true, shift == 0},
          scatter_in_parallel(keys_.size(), entry, digit, scratch), ready);
    sort_all(ready);
  }

  bool stopped() const { return stopped_; }

 private:
  /// Once stopping, always stopping: a range that was left unsorted must not be taken for sorted.
  bool stopping() const {
    if (monitor_.stopping()) stopped_ = true;
    return stopped_;
  }

  void take_as_they_are(Entries entries) const {
    for (std::size_t i = 0; i < entries.size(); ++i)
      entries[i] = {0, static_cast<std::uint32_t>(i)};
    if (!tie_) return;
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin + 1;
      while (end < entries.size() && keys_[end] == keys_[begin]) ++end;
      if (end - begin > 1) sort_ties(entries.subspan(begin, end - begin));
      begin = end;
    }
  }

  void sort_all(const std::vector<Part>& parts) const {
    parallel_for(parts.size(), 8, [&](std::size_t begin, std::size_t end) {
      if (stopping()) return;
      for (std::size_t i = begin; i < end; ++i) sort(parts[i]);
    });
  }

  /// Splits long ranges by all threads until the rest is worth sharing out.
  void split(const Part& part, std::vector<Part>& ready) const {
    if (part.here.size() <= kLarge || stopping()) return ready.push_back(part);
    const int highest = highest_bit(difference_in_parallel(part.here));
    if (highest < 0) return split_equal_bits(part, ready);
    const auto entry = [&](std::size_t i) { return part.here[i]; };
    const Digit digit = digit_for(part.here.size(), highest);
    split(part, scatter_in_parallel(part.here.size(), entry, digit, part.there), ready);
  }

  /// The buckets of a range, which now lie in its other buffer.
  void split(const Part& part, const std::vector<std::uint32_t>& starts,
             std::vector<Part>& ready) const {
    for (std::size_t b = 0; b + 1 < starts.size(); ++b)
      if (starts[b + 1] > starts[b]) split(bucket(part, starts[b], starts[b + 1]), ready);
  }

  void split_equal_bits(const Part& part, std::vector<Part>& ready) const {
    if (part.exact) return ready.push_back(part);
    parallel_for(part.here.size(), kScanGrain, [&](std::size_t begin, std::size_t end) {
      use_low_bits(part.here.subspan(begin, end - begin));
    });
    split({part.here, part.there, part.home, true}, ready);
  }

  static Part bucket(const Part& part, std::size_t begin, std::size_t end) {
    return {part.there.subspan(begin, end - begin), part.here.subspan(begin, end - begin),
            !part.home, part.exact};
  }

  void sort(const Part& part) const {
    if (part.here.size() <= kSmall) return sort_small(part);
    const int highest = highest_bit(difference(part.here, part.here[0].bits));
    if (highest < 0) return sort_equal_bits(part);
    const Digit digit = digit_for(part.here.size(), highest);
    Starts starts;
    scatter(part.here, digit, part.there, starts);
    for (std::size_t b = 0; b < digit.buckets(); ++b)
      if (starts[b + 1] > starts[b]) sort(bucket(part, starts[b], starts[b + 1]));
  }

  void sort_equal_bits(const Part& part) const {
    if (part.exact) return sort_ties(bring_home(part));
    use_low_bits(part.here);
    sort({part.here, part.there, part.home, true});
  }

  /// Keys that share 64 bits from the highest that differs can differ in their lower words only.
  void use_low_bits(Entries entries) const {
    for (KeyEntry& e : entries) e.bits = keys_[e.index].low;
  }

  static Entries bring_home(const Part& part) {
    if (part.home) return part.here;
    std::ranges::copy(part.here, part.there.begin());
    return part.there;
  }

  void sort_small(const Part& part) const {
    const Entries entries = bring_home(part);
    for (std::size_t i = 1; i < entries.size(); ++i) {
      const KeyEntry e = entries[i];
      std::size_t at = i;
      for (; at > 0 && comes_before(e, entries[at - 1], part.exact); --at)
        entries[at] = entries[at - 1];
      entries[at] = e;
    }
  }

  void sort_ties(Entries entries) const {
    std::ranges::sort(entries, [&](const KeyEntry& a, const KeyEntry& b) {
      return tied_before(a.index, b.index);
    });
  }

  bool comes_before(const KeyEntry& a, const KeyEntry& b, bool exact) const {
    if (a.bits != b.bits) return a.bits < b.bits;
    const Key &x = keys_[a.index], &y = keys_[b.index];
    return exact || x == y ? tied_before(a.index, b.index) : x < y;
  }

  bool tied_before(std::uint32_t a, std::uint32_t b) const { return tie_ ? tie_(a, b) : a < b; }

  std::span<const Key> keys_;
  const TieBreak& tie_;
  const Monitor& monitor_;
  mutable std::atomic<bool> stopped_{false};
};

}  // namespace

bool sort_keys(std::span<const Key> keys, std::span<KeyEntry> entries, std::span<KeyEntry> scratch,
               const TieBreak& tie, const Monitor& monitor) {
  assert(entries.size() == keys.size() && scratch.size() == keys.size());
  Sorter sorter(keys, tie, monitor);
  sorter.run(entries, scratch);
  return !sorter.stopped();
}

}  // namespace pss
