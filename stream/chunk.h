#pragma once
// Points collected in memory, sorted there, and given out in order.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/keyed_rows.h"
#include "stream/sort.h"
#include "stream/sorted_stream.h"

namespace pss {

class Chunk {
 public:
  Chunk(std::size_t capacity, std::size_t row_size);

  std::size_t size() const { return entries_.size(); }
  std::size_t room() const { return capacity_ - entries_.size(); }

  /// Requires: room for all of `points`.
  void add(const KeyedRows& points);
  /// Errors: kInterrupted.
  Result<void> sort(const Monitor& monitor);
  void clear();

  // After sort(): the points in order. Thread: any number at once.
  const Key& key(std::size_t i) const { return entries_[i].key; }
  const std::byte* row(std::size_t i) const { return rows_.data() + entries_[i].row * row_size_; }
  void get(std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) const;

  std::size_t row_size() const { return row_size_; }

  /// Bytes a point holds, and bytes more while the chunk is being sorted.
  static std::uint64_t bytes_per_point(std::size_t row_size);
  static constexpr std::uint64_t kSortBytesPerPoint = sizeof(SortEntry);

 private:
  std::size_t capacity_;
  std::size_t row_size_;
  std::vector<SortEntry> entries_;
  std::vector<std::byte> rows_;
};

/// A sorted chunk from its `begin`-th point on.
class ChunkStream : public SortedStream {
 public:
  ChunkStream(const Chunk& chunk, std::size_t begin) : chunk_(chunk), next_(begin) {}

  Result<void> read(std::size_t max, KeyedRows& out) override;

 private:
  const Chunk& chunk_;
  std::size_t next_;
};

}  // namespace pss
