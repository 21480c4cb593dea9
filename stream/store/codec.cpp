#include "stream/store/codec.h"

#include <lz4.h>

#include <cassert>
#include <cstring>
#include <memory>
#include <type_traits>

namespace pss {
namespace {

constexpr std::byte kLz4Flag{1};
constexpr std::byte kDeltaFlag{2};
constexpr std::byte kAllFlags{3};

template <class U>
U zigzag(U difference) {
  const U sign = static_cast<U>(difference >> (8 * sizeof(U) - 1));
  return static_cast<U>((difference << 1) ^ static_cast<U>(U{0} - sign));
}

template <class U>
U unzigzag(U coded) {
  return static_cast<U>((coded >> 1) ^ static_cast<U>(U{0} - (coded & U{1})));
}

/// The bytes of one lane's values, lowest bytes first: planes[b * count + i].
template <class U>
void split_lane(const std::byte* values, const ColumnShape& shape, std::byte* planes) {
  U previous = 0;
  for (std::size_t i = 0; i < shape.count; ++i) {
    U value;
    std::memcpy(&value, values + i * shape.stride, sizeof(U));
    const U coded = shape.delta ? zigzag(static_cast<U>(value - previous)) : value;
    previous = value;
    for (std::size_t b = 0; b < sizeof(U); ++b)
      planes[b * shape.count + i] = static_cast<std::byte>(coded >> (8 * b));
  }
}

template <class U>
U join_bytes(const std::byte* planes, std::size_t count, std::size_t i) {
  U value = 0;
  for (std::size_t b = 0; b < sizeof(U); ++b)
    value =
        static_cast<U>(value | static_cast<U>(static_cast<U>(planes[b * count + i]) << (8 * b)));
  return value;
}

template <class U>
void join_lane(const std::byte* planes, const ColumnShape& shape, bool delta, std::byte* values) {
  U previous = 0;
  for (std::size_t i = 0; i < shape.count; ++i) {
    U value = join_bytes<U>(planes, shape.count, i);
    if (delta) value = previous = static_cast<U>(previous + unzigzag(value));
    std::memcpy(values + i * shape.stride, &value, sizeof(U));
  }
}

/// Calls `body(U{})` with the unsigned type of `width` bytes.
template <class Body>
void with_width(std::size_t width, const Body& body) {
  switch (width) {
    case 1:
      return body(std::uint8_t{});
    case 2:
      return body(std::uint16_t{});
    case 4:
      return body(std::uint32_t{});
    default:
      assert(width == 8);
      return body(std::uint64_t{});
  }
}

void split(const std::byte* values, const ColumnShape& shape, std::byte* planes) {
  for (std::size_t lane = 0; lane < shape.lanes; ++lane)
    with_width(shape.width, [&](auto type) {
      split_lane<decltype(type)>(values + lane * shape.width, shape,
                                 planes + lane * shape.width * shape.count);
    });
}

void join(const std::byte* planes, const ColumnShape& shape, bool delta, std::byte* values) {
  for (std::size_t lane = 0; lane < shape.lanes; ++lane)
    with_width(shape.width, [&](auto type) {
      join_lane<decltype(type)>(planes + lane * shape.width * shape.count, shape, delta,
                                values + lane * shape.width);
    });
}

bool decompress(std::span<const std::byte> in, std::span<std::byte> out) {
  if (in.size() > LZ4_MAX_INPUT_SIZE || out.size() > LZ4_MAX_INPUT_SIZE) return false;
  const int size = LZ4_decompress_safe(reinterpret_cast<const char*>(in.data()),
                                       reinterpret_cast<char*>(out.data()),
                                       static_cast<int>(in.size()), static_cast<int>(out.size()));
  return size >= 0 && static_cast<std::size_t>(size) == out.size();
}

}  // namespace

std::size_t column_bound(std::size_t bytes) { return bytes + 1; }

void append_column(const std::byte* values, const ColumnShape& shape, std::vector<std::byte>& out) {
  assert(shape.bytes() <= LZ4_MAX_INPUT_SIZE);
  const std::size_t size = shape.bytes();
  const auto planes = std::make_unique_for_overwrite<std::byte[]>(size);
  split(values, shape, planes.get());

  const std::size_t start = out.size();
  const std::byte delta = shape.delta ? kDeltaFlag : std::byte{0};
  out.resize(start + 1 + size);
  // The target is as large as the source: where LZ4 gains nothing, it gives up.
  const int packed = size == 0
                         ? 0
                         : LZ4_compress_default(reinterpret_cast<const char*>(planes.get()),
                                                reinterpret_cast<char*>(out.data() + start + 1),
                                                static_cast<int>(size), static_cast<int>(size) - 1);
  out[start] = packed > 0 ? delta | kLz4Flag : delta;
  if (packed > 0) return out.resize(start + 1 + static_cast<std::size_t>(packed));
  if (size > 0) std::memcpy(out.data() + start + 1, planes.get(), size);
}

bool decode_column(std::span<const std::byte> column, const ColumnShape& shape, std::byte* values) {
  if (column.empty() || (column[0] & ~kAllFlags) != std::byte{0}) return false;
  const bool delta = (column[0] & kDeltaFlag) != std::byte{0};
  const auto payload = column.subspan(1);
  if ((column[0] & kLz4Flag) == std::byte{0}) {
    if (payload.size() != shape.bytes()) return false;
    return join(payload.data(), shape, delta, values), true;
  }
  const auto planes = std::make_unique_for_overwrite<std::byte[]>(shape.bytes());
  if (!decompress(payload, {planes.get(), shape.bytes()})) return false;
  return join(planes.get(), shape, delta, values), true;
}

}  // namespace pss
