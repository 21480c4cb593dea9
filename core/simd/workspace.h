#pragma once
// Memory that kernels use again and again: aligned, growing, of no target.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>

namespace pss::simd {

/// An array aligned for every vector, whose contents are lost when it grows, but for those kept.
template <class T>
class Buffer {
 public:
  static constexpr std::size_t kAlignment = 64;

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t capacity() const { return capacity_; }

  /// Makes room for `count` elements; the first `kept` stay.
  void reserve(std::size_t count, std::size_t kept = 0) {
    if (count <= capacity_) return;
    const std::size_t grown = count + count / 4;
    if (kept == 0) data_.reset();
    std::unique_ptr<T[], Free> larger(
        static_cast<T*>(::operator new (grown * sizeof(T), std::align_val_t{kAlignment})));
    std::copy_n(data_.get(), kept, larger.get());
    data_ = std::move(larger);
    capacity_ = grown;
  }

 private:
  struct Free {
    void operator()(T* p) const { ::operator delete (p, std::align_val_t{kAlignment}); }
  };

  std::unique_ptr<T[], Free> data_;
  std::size_t capacity_ = 0;
};

}  // namespace pss::simd
