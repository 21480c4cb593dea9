#pragma once
// Points collected in memory, sorted there, and given out in order.

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/key_sort.h"
#include "core/monitor.h"
#include "core/result.h"
#include "stream/big_array.h"
#include "stream/keyed_rows.h"
#include "stream/sorted_stream.h"

namespace pss {

class Chunk {
 public:
  Chunk(std::size_t capacity, std::size_t row_size);

  std::size_t size() const { return size_; }
  std::size_t room() const { return keys_.size() - size_; }

  /// Requires: room for all of them.
  void add(std::span<const Key> keys, std::span<const std::byte> rows);
  /// Errors: kInterrupted.
  Result<void> sort(const Monitor& monitor);
  void clear() { size_ = 0; }
  /// Gives back what only sorting needs.
  void end_sorting() { scratch_ = {}; }

  // After sort(): the points in order. Thread: any number at once.
  const Key& key(std::size_t i) const { return keys_[entries_[i].index]; }
  const std::byte* row(std::size_t i) const { return row_at(entries_[i].index); }
  /// Copies the points [begin, begin + keys.size()) out.
  void get(std::size_t begin, std::span<Key> keys, std::span<std::byte> rows) const;
  void get(std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) const;
  /// Replaces `out` by the points from `next` on, at most `max`; `next` moves past them.
  void read(std::size_t& next, std::size_t max, KeyedRows& out) const;

  std::size_t row_size() const { return row_size_; }

  /// Bytes a point holds, and bytes more until sorting has ended.
  static std::uint64_t bytes_per_point(std::size_t row_size);
  static std::uint64_t sort_bytes_per_point();

 private:
  const std::byte* row_at(std::size_t index) const { return rows_.data() + index * row_size_; }
  template <class Body>
  void visit(std::size_t begin, std::size_t count, const Body& body) const;
  std::size_t row_size_;
  std::size_t size_ = 0;
  BigArray<Key> keys_;
  BigArray<std::byte> rows_;
  BigArray<KeyEntry> entries_, scratch_;
};

/// A sorted chunk from its `begin`-th point on.
class ChunkStream : public SortedStream {
 public:
  ChunkStream(const Chunk& chunk, std::size_t begin) : chunk_(chunk), next_(begin) {}

  Result<void> read(std::size_t max, KeyedRows& out) override {
    chunk_.read(next_, max, out);
    return {};
  }

 private:
  const Chunk& chunk_;
  std::size_t next_;
};

}  // namespace pss
