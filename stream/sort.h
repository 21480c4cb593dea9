#pragma once
// Sorts points in memory into the one order: by key, then by the bytes of their rows.

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/monitor.h"
#include "core/morton.h"

namespace pss {

/// A point to sort: its key, and which row is its own.
struct SortEntry {
  Key key;
  std::uint32_t row = 0;
};

/// Sorts entries; rows stay where they are.
///
/// Shape:  `scratch` as long as `entries`; `rows` holds row_size bytes for every row named.
/// Errors: none; false where `monitor` was stopping, and then the order is any.
/// Cost:   O(n) for keys that are spread out: buckets by the leading bits that differ (MSD radix),
///         small buckets by comparison; parallel over buckets.
[[nodiscard]] bool sort_entries(std::span<SortEntry> entries, std::span<SortEntry> scratch,
                                const std::byte* rows, std::size_t row_size,
                                const Monitor& monitor);

}  // namespace pss
