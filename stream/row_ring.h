#pragma once
// A queue of points of fixed capacity: what a tile is cut from.

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "core/morton.h"
#include "stream/keyed_rows.h"

namespace pss {

class RowRing {
 public:
  RowRing(std::size_t capacity, std::size_t row_size)
      : row_size_(row_size), keys_(capacity), rows_(capacity * row_size) {}

  std::size_t size() const { return size_; }
  std::size_t room() const { return keys_.size() - size_; }
  const Key& key(std::size_t i) const { return keys_[slot(i)]; }

  /// Requires: room for all of `points`.
  void push(const KeyedRows& points) {
    assert(points.size() <= room());
    for (std::size_t done = 0; done < points.size();) {
      const std::size_t at = slot(size_);
      const std::size_t n = std::min(points.size() - done, keys_.size() - at);
      std::copy_n(points.keys.begin() + static_cast<std::ptrdiff_t>(done), n,
                  keys_.begin() + static_cast<std::ptrdiff_t>(at));
      copy_bytes(rows_.data() + at * row_size_, points.row(done), n);
      size_ += n;
      done += n;
    }
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
  void copy_bytes(std::byte* to, const std::byte* from, std::size_t rows) const {
    if (row_size_ > 0) std::memcpy(to, from, rows * row_size_);
  }

  std::size_t row_size_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  std::vector<Key> keys_;
  std::vector<std::byte> rows_;
};

}  // namespace pss
