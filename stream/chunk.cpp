#include "stream/chunk.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace pss {

Chunk::Chunk(std::size_t capacity, std::size_t row_size)
    : capacity_(capacity), row_size_(row_size) {
  entries_.reserve(capacity);
  rows_.reserve(capacity * row_size);
}

void Chunk::add(const KeyedRows& points) {
  assert(points.size() <= room());
  for (const Key& key : points.keys)
    entries_.push_back({key, static_cast<std::uint32_t>(entries_.size())});
  rows_.insert(rows_.end(), points.rows.begin(), points.rows.end());
}

Result<void> Chunk::sort(const Monitor& monitor) {
  std::vector<SortEntry> scratch(entries_.size());
  if (sort_entries(entries_, scratch, rows_.data(), row_size_, monitor)) return {};
  return Error{Fault::kInterrupted, "stopped while sorting points"};
}

void Chunk::clear() {
  entries_.clear();
  rows_.clear();
}

void Chunk::get(std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) const {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = decode_key(key(begin + i));
    if (row_size_ > 0) std::memcpy(rows.data() + i * row_size_, row(begin + i), row_size_);
  }
}

std::uint64_t Chunk::bytes_per_point(std::size_t row_size) { return sizeof(SortEntry) + row_size; }

Result<void> ChunkStream::read(std::size_t max, KeyedRows& out) {
  const std::size_t n = std::min(max, chunk_.size() - next_);
  out.row_size = chunk_.row_size();
  out.keys.resize(n);
  out.rows.resize(n * out.row_size);
  for (std::size_t i = 0; i < n; ++i) {
    out.keys[i] = chunk_.key(next_ + i);
    if (out.row_size > 0)
      std::memcpy(out.rows.data() + i * out.row_size, chunk_.row(next_ + i), out.row_size);
  }
  next_ += n;
  return {};
}

}  // namespace pss
