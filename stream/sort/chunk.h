#pragma once
// Points collected in memory, sorted there, and given out in order.

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/key_sort.h"
#include "core/monitor.h"
#include "core/result.h"
#include "stream/sort/big_array.h"
#include "stream/sort/sorted_stream.h"
#include "stream/store/keyed_rows.h"

namespace pss {

class Chunk {
 public:
  Chunk(std::size_t capacity, std::size_t row_size);

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return keys_.size(); }
  std::size_t room() const { return capacity() - size_; }

  // Points are added in two steps, so that all threads make them where they will lie: each writes
  // to places of its own, size() or beyond, and then places are taken in, one batch at a time.
  /// The places of points [begin, begin + count). Thread: any.
  std::span<Key> key_places(std::size_t begin, std::size_t count) const;
  std::span<std::byte> row_places(std::size_t begin, std::size_t count) const;
  /// The points that were written to places [begin, begin + count) follow the last one now.
  ///
  /// They move where that one lies further ahead; places behind them stay as they are.
  void take_in(std::size_t begin, std::size_t count);
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
  /// Copies the points from `next` on, as many as there are and have room; `next` moves past them.
  std::size_t read(std::size_t& next, std::span<Key> keys, std::span<std::byte> rows) const;

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

  Result<std::size_t> read(std::span<Key> keys, std::span<std::byte> rows) override {
    return chunk_.read(next_, keys, rows);
  }

 private:
  const Chunk& chunk_;
  std::size_t next_;
};

}  // namespace pss
