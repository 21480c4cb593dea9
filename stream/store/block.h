#pragma once
// A block: some thousands of consecutive rows, each column compressed apart.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "io/points/schema.h"

namespace pss {

inline constexpr std::uint32_t kBlockPoints = 4096;  ///< a block holds at most so many

/// A column of a block: where its compressed bytes are in the segment, and their hash.
struct ColumnInfo {
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  std::uint64_t hash = 0;
};

/// A block's entry in its tile's index. Column 0 is the position, column 1 + f is field f.
struct BlockInfo {
  std::uint32_t count = 0;
  std::uint64_t first_row = 0;
  IndexBox box;
  std::vector<ColumnInfo> columns;
};

/// A compressed block on its way to a store, made by any thread.
struct EncodedBlock {
  std::uint32_t count = 0;
  IndexBox box;
  std::vector<std::byte> bytes;
  std::vector<ColumnInfo> columns;  ///< offsets relative to `bytes`
};

/// Compresses up to kBlockPoints rows.
///
/// Shape:  `positions` n, `rows` n * schema.row_size() bytes.
/// Thread: any number at once.
EncodedBlock encode_block(const Schema& schema, std::span<const Index3> positions,
                          std::span<const std::byte> rows);

/// What encode_block holds at most while it works on `count` rows, its result included.
std::size_t encode_bytes(const Schema& schema, std::size_t count);

/// The bytes of a column to its positions; false where they are no such column. Safe on any bytes.
bool decode_positions(std::span<const std::byte> column, std::span<Index3> out);

/// The bytes of a field's column to `count` values `stride` bytes apart, the first at `out`.
bool decode_field(const Field& field, std::span<const std::byte> column, std::size_t count,
                  std::byte* out, std::size_t stride);

IndexBox box_of(std::span<const Index3> positions);

/// The most bytes a column may have in a file: more is damage. Column 0 is the position.
std::size_t column_limit(const Schema& schema, std::size_t column, std::size_t count);

}  // namespace pss
