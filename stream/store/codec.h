#pragma once
// How a column of values becomes few bytes: delta, byte shuffle, LZ4; and safely back.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pss {

/// Values of `width` bytes (1, 2, 4 or 8), `lanes` of them side by side every `stride` bytes.
///
/// A field of a row is such a column: its stride is the size of the row.
struct ColumnShape {
  std::size_t count = 0;
  std::size_t lanes = 1;
  std::size_t width = 1;
  std::size_t stride = 1;
  bool delta = false;  ///< only for encoding: store differences of consecutive values

  std::size_t bytes() const { return count * lanes * width; }
};

/// The most bytes that append_column adds for a column of `bytes` bytes.
std::size_t column_bound(std::size_t bytes);

/// Appends the encoded column to `out`.
///
/// Layout: one byte of flags (1: LZ4, else as is; 2: delta), then for each lane, for each byte of
/// the value from the lowest, that byte of all values in turn. Differences wrap around and are
/// zig-zag coded, the first against zero.
/// Thread: any number at once.
void append_column(const std::byte* values, const ColumnShape& shape, std::vector<std::byte>& out);

/// Writes the values of an encoded column to `values`; false where the bytes are no such column.
///
/// Safe on any bytes. Thread: any number at once.
bool decode_column(std::span<const std::byte> column, const ColumnShape& shape, std::byte* values);

}  // namespace pss
