#pragma once
// Sorts points in memory by their keys: the order in which everything else takes them.

#include <cstdint>
#include <functional>
#include <span>

#include "core/monitor.h"
#include "core/morton.h"

namespace pss {

/// A point being sorted: 64 bits of its key, from the highest that differs, and its number.
struct KeyEntry {
  std::uint64_t bits = 0;
  std::uint32_t index = 0;
};

/// Whether point `a` comes before point `b`; asked only for two of equal keys.
using TieBreak = std::function<bool(std::uint32_t a, std::uint32_t b)>;

/// Leaves in entries[i].index the number of the i-th key in order; `bits` are for its own use.
///
/// Equal keys are ordered by `tie`, and without one by their numbers.
/// Shape:  `entries` and `scratch` as long as `keys`, at most 2^31; what is in them does not
/// matter.
/// Thread: parallel, also within one range; the order depends on neither. `tie` is called by any.
/// Errors: none; false where `monitor` was stopping, and then the order is any.
/// Cost:   O(n): buckets by leading bits that differ (MSD radix), the last few by insertion. Keys
///         in order already are only read. Equal keys cost O(m log m) calls of `tie`.
[[nodiscard]] bool sort_keys(std::span<const Key> keys, std::span<KeyEntry> entries,
                             std::span<KeyEntry> scratch, const TieBreak& tie = nullptr,
                             const Monitor& monitor = Monitor());

}  // namespace pss
