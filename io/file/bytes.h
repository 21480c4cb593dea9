#pragma once
// Little-endian values in bytes, without regard to alignment.

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

namespace pss {

static_assert(std::endian::native == std::endian::little);

/// Requires: offset + sizeof(T) <= bytes.size().
template <class T>
requires std::is_arithmetic_v<T> T load_le(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Requires: offset + sizeof(T) <= bytes.size().
template <class T>
requires std::is_arithmetic_v<T>
void store_le(std::span<std::byte> bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// The text of a fixed-size field, up to its first zero byte.
inline std::string text_in(std::span<const std::byte> bytes) {
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.substr(0, text.find('\0'));
}

}  // namespace pss
