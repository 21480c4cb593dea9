#pragma once
// Values to little-endian bytes and back, never reading beyond the end.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pss {

static_assert(std::endian::native == std::endian::little, "rows and files are little-endian");

/// Appends values to a vector of bytes.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { raw(std::as_bytes(std::span(&value, 1))); }

  /// Bytes without their length.
  void raw(std::span<const std::byte> bytes) {
    const std::size_t start = out_.size();
    out_.resize(start + bytes.size());
    if (!bytes.empty()) std::memcpy(out_.data() + start, bytes.data(), bytes.size());
  }
  /// A length of 4 bytes, then the bytes.
  void bytes(std::span<const std::byte> bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    raw(bytes);
  }
  void text(std::string_view text) { bytes(std::as_bytes(std::span(text))); }

 private:
  std::vector<std::byte>& out_;
};

/// Takes values from bytes; after the first that does not fit, everything is zero and ok() false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    T value{};
    const auto bytes = raw(sizeof(T));
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  std::span<const std::byte> raw(std::size_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const auto bytes = rest_.first(size);
    rest_ = rest_.subspan(size);
    return bytes;
  }
  std::span<const std::byte> bytes() { return raw(get<std::uint32_t>()); }
  std::string text() {
    const auto found = bytes();
    return {reinterpret_cast<const char*>(found.data()), found.size()};
  }
  /// A number of items of at least `smallest` bytes each; more than can follow is a failure.
  std::size_t count(std::size_t smallest) {
    const std::size_t items = get<std::uint32_t>();
    if (items > rest_.size() / smallest) ok_ = false;
    return ok_ ? items : 0;
  }

  void fail() { ok_ = false; }
  bool ok() const { return ok_; }
  /// Everything was read, and nothing is left over.
  bool finished() const { return ok_ && rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
};

}  // namespace pss
