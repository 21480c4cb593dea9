#pragma once
// Points on their way into a store: a key and the bytes of a row each, and the one order of them.

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "core/morton.h"

namespace pss {

/// Points as parallel arrays: the row of point i begins at rows[i * row_size].
struct KeyedRows {
  KeyedRows(std::size_t count, std::size_t row_bytes)
      : row_size(row_bytes), keys(count), rows(count * row_bytes) {}

  std::size_t row_size;
  std::vector<Key> keys;
  std::vector<std::byte> rows;

  const std::byte* row(std::size_t i) const { return rows.data() + i * row_size; }
};

/// The order of points: key, then the bytes of the row. Equal points are interchangeable.
inline bool before(const Key& a, const std::byte* row_a, const Key& b, const std::byte* row_b,
                   std::size_t row_size) {
  if (a != b) return a < b;
  return row_size > 0 && std::memcmp(row_a, row_b, row_size) < 0;
}

/// Copies a row; lengths that are common are known to the compiler, which spares a call.
inline void copy_row(std::byte* to, const std::byte* from, std::size_t size) {
  switch (size) {
    case 0:
      return;
    case 8:
      std::memcpy(to, from, 8);
      return;
    case 16:
      std::memcpy(to, from, 16);
      return;
    default:
      std::memcpy(to, from, size);
  }
}

}  // namespace pss
