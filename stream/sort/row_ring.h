#pragma once
// A queue of points of fixed capacity: what a tile is cut from.

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "core/morton.h"
#include "stream/store/keyed_rows.h"

namespace pss {

class RowRing {
 public:
  RowRing(std::size_t capacity, std::size_t row_size)
      : row_size_(row_size), keys_(capacity), rows_(capacity * row_size) {}

  std::size_t size() const { return size_; }
  std::size_t room() const { return keys_.size() - size_; }
  const Key& key(std::size_t i) const { return keys_[slot(i)]; }

  /// Places behind the last point, as many as lie side by side; none where there is no room.
  std::span<Key> free_keys() { return {keys_.data() + slot(size_), free_at_once()}; }
  std::span<std::byte> free_rows() {
    return {rows_.data() + slot(size_) * row_size_, free_at_once() * row_size_};
  }
  /// Points were written to the first `count` free places.
  void push(std::size_t count) {
    assert(count <= free_at_once());
    size_ += count;
  }

  /// Copies points [begin, begin + positions.size()) out. Thread: any number at once.
  void get(std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) const {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const std::size_t at = slot(begin + i);
      positions[i] = decode_key(keys_[at]);
      copy_row(rows.data() + i * row_size_, rows_.data() + at * row_size_, row_size_);
    }
  }

  void pop(std::size_t count) {
    assert(count <= size_);
    head_ = slot(count);
    size_ -= count;
  }

 private:
  std::size_t slot(std::size_t i) const {
    const std::size_t at = head_ + i;
    return at < keys_.size() ? at : at - keys_.size();
  }
  std::size_t free_at_once() const { return std::min(room(), keys_.size() - slot(size_)); }

  std::size_t row_size_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  std::vector<Key> keys_;
  std::vector<std::byte> rows_;
};

}  // namespace pss
