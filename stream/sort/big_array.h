#pragma once
// Large arrays whose memory is used once it is touched, and given back when they go.

#include <cstddef>
#include <span>
#include <type_traits>

namespace pss {

/// Bytes of zeros. Errors: std::bad_alloc, as of a vector.
class BigBytes {
 public:
  BigBytes() = default;
  explicit BigBytes(std::size_t size);
  BigBytes(BigBytes&& other) noexcept;
  BigBytes& operator=(BigBytes&& other) noexcept;
  ~BigBytes();

  std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// A fixed number of plain values, zero at first.
template <class T>
class BigArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  BigArray() = default;
  explicit BigArray(std::size_t count) : bytes_(count * sizeof(T)), count_(count) {}

  T* data() const { return reinterpret_cast<T*>(bytes_.data()); }
  std::size_t size() const { return count_; }
  T& operator[](std::size_t i) const { return data()[i]; }
  std::span<T> first(std::size_t count) const { return {data(), count}; }

 private:
  BigBytes bytes_;
  std::size_t count_ = 0;
};

}  // namespace pss
