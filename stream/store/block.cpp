#include "stream/store/block.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>
#include <memory>

#include "io/file/hash.h"
#include "stream/store/bytes.h"
#include "stream/store/codec.h"

namespace pss {
namespace {

/// Offset width (4 or 8), then the origin.
constexpr std::size_t kPositionHead = 1 + 3 * sizeof(std::int64_t);

template <class U>
using Offsets3 = std::array<U, 3>;

/// Differences and sums wrap around, so that any 64-bit positions survive.
std::uint64_t wrap(std::int64_t value) { return static_cast<std::uint64_t>(value); }

ColumnShape field_shape(const Field& field, std::size_t count, std::size_t stride) {
  const std::size_t width = size_of(field.type);
  return {count, field.count, width, stride, width > 1 && !is_float(field.type)};
}

template <class U>
ColumnShape offset_shape(std::size_t count) {
  return {count, 3, sizeof(U), sizeof(Offsets3<U>), true};
}

bool fits_32_bits(const IndexBox& box) {
  for (std::size_t a = 0; a < 3; ++a)
    if (wrap(box.max[a]) - wrap(box.min[a]) > std::numeric_limits<std::uint32_t>::max())
      return false;
  return true;
}

template <class U>
void append_offsets(std::span<const Index3> positions, const Index3& origin,
                    std::vector<std::byte>& out) {
  const auto offsets = std::make_unique_for_overwrite<Offsets3<U>[]>(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      offsets[i][a] = static_cast<U>(wrap(positions[i][a]) - wrap(origin[a]));
  append_column(reinterpret_cast<const std::byte*>(offsets.get()),
                offset_shape<U>(positions.size()), out);
}

void append_positions(std::span<const Index3> positions, const IndexBox& box,
                      std::vector<std::byte>& out) {
  const bool narrow = fits_32_bits(box);
  ByteWriter writer(out);
  writer.put<std::uint8_t>(narrow ? 4 : 8);
  for (const std::int64_t o : box.min) writer.put(o);
  narrow ? append_offsets<std::uint32_t>(positions, box.min, out)
         : append_offsets<std::uint64_t>(positions, box.min, out);
}

template <class U>
bool decode_offsets(std::span<const std::byte> column, const Index3& origin,
                    std::span<Index3> out) {
  const auto offsets = std::make_unique_for_overwrite<Offsets3<U>[]>(out.size());
  if (!decode_column(column, offset_shape<U>(out.size()),
                     reinterpret_cast<std::byte*>(offsets.get())))
    return false;
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      out[i][a] = static_cast<std::int64_t>(wrap(origin[a]) + offsets[i][a]);
  return true;
}

/// Notes what was appended to the block since its last column.
void end_column(EncodedBlock& block) {
  const std::uint64_t start =
      block.columns.empty() ? 0 : block.columns.back().offset + block.columns.back().size;
  const auto bytes = std::span(block.bytes).subspan(start);
  block.columns.push_back({start, static_cast<std::uint32_t>(bytes.size()), hash64(bytes)});
}

}  // namespace

IndexBox box_of(std::span<const Index3> positions) {
  if (positions.empty()) return {};
  Index3 low = positions[0], high = positions[0];
  for (const Index3& p : positions)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  return {low, high};
}

EncodedBlock encode_block(const Schema& schema, std::span<const Index3> positions,
                          std::span<const std::byte> rows) {
  assert(positions.size() <= kBlockPoints && !positions.empty());
  assert(rows.size() == positions.size() * schema.row_size());
  EncodedBlock block;
  block.count = static_cast<std::uint32_t>(positions.size());
  block.box = box_of(positions);
  block.bytes.reserve(rows.size() / 2 + positions.size() * 10);
  append_positions(positions, block.box, block.bytes);
  end_column(block);
  for (std::size_t f = 0; f < schema.fields().size(); ++f) {
    append_column(rows.data() + schema.position(f),
                  field_shape(schema.fields()[f], positions.size(), schema.row_size()),
                  block.bytes);
    end_column(block);
  }
  block.bytes.shrink_to_fit();  // it may wait long to be written
  return block;
}

std::size_t encode_bytes(const Schema& schema, std::size_t count) {
  const std::size_t row = sizeof(Index3) + schema.row_size();
  // The growing result may exist twice for a moment; the widest column's planes come on top.
  return 3 * count * row + 64 * (schema.fields().size() + 2);
}

bool decode_positions(std::span<const std::byte> column, std::span<Index3> out) {
  if (column.size() < kPositionHead) return false;
  ByteReader reader(column);
  const auto width = reader.get<std::uint8_t>();
  Index3 origin;
  for (std::int64_t& o : origin) o = reader.get<std::int64_t>();
  const auto offsets = column.subspan(kPositionHead);
  if (width == 4) return decode_offsets<std::uint32_t>(offsets, origin, out);
  return width == 8 && decode_offsets<std::uint64_t>(offsets, origin, out);
}

bool decode_field(const Field& field, std::span<const std::byte> column, std::size_t count,
                  std::byte* out, std::size_t stride) {
  return decode_column(column, field_shape(field, count, stride), out);
}

std::size_t column_limit(const Schema& schema, std::size_t column, std::size_t count) {
  if (column > 0) return column_bound(count * schema.fields()[column - 1].size());
  return kPositionHead + column_bound(count * sizeof(Index3));
}

}  // namespace pss
