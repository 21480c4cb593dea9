#include "stream/sort/chunk.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "core/parallel.h"

namespace pss {
namespace {

/// Points are asked for so far ahead: they lie anywhere in memory, and are there when needed.
constexpr std::size_t kAhead = 24;
constexpr std::size_t kGrain = 4096;
/// Places in the sort's list of buckets; see core/key_sort.
constexpr std::size_t kSortListBytes = 3;

}  // namespace

Chunk::Chunk(std::size_t capacity, std::size_t row_size)
    : row_size_(row_size),
      keys_(capacity),
      rows_(capacity * row_size),
      entries_(capacity),
      scratch_(capacity) {}

std::span<Key> Chunk::key_places(std::size_t begin, std::size_t count) const {
  assert(begin + count <= capacity());
  return {keys_.data() + begin, count};
}

std::span<std::byte> Chunk::row_places(std::size_t begin, std::size_t count) const {
  assert(begin + count <= capacity());
  return {rows_.data() + begin * row_size_, count * row_size_};
}

void Chunk::take_in(std::size_t begin, std::size_t count) {
  assert(begin >= size_);
  if (begin > size_) {
    std::ranges::copy(key_places(begin, count), keys_.data() + size_);
    std::ranges::copy(row_places(begin, count), rows_.data() + size_ * row_size_);
  }
  size_ += count;
}

Result<void> Chunk::sort(const Monitor& monitor) {
  const TieBreak by_row = [&](std::uint32_t a, std::uint32_t b) {
    return row_size_ > 0 && std::memcmp(row_at(a), row_at(b), row_size_) < 0;
  };
  if (sort_keys(keys_.first(size_), entries_.first(size_), scratch_.first(size_), by_row, monitor))
    return {};
  return Error{Fault::kInterrupted, "stopped while sorting points"};
}

template <class Body>
void Chunk::visit(std::size_t begin, std::size_t count, const Body& body) const {
  for (std::size_t i = 0; i < count; ++i) {
    if (begin + i + kAhead < size_) {
      const std::uint32_t ahead = entries_[begin + i + kAhead].index;
      __builtin_prefetch(&keys_[ahead]);
      __builtin_prefetch(row_at(ahead));
    }
    const std::uint32_t index = entries_[begin + i].index;
    body(i, keys_[index], row_at(index));
  }
}

void Chunk::get(std::size_t begin, std::span<Key> keys, std::span<std::byte> rows) const {
  visit(begin, keys.size(), [&](std::size_t i, const Key& key, const std::byte* row) {
    keys[i] = key;
    copy_row(rows.data() + i * row_size_, row, row_size_);
  });
}

void Chunk::get(std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) const {
  visit(begin, positions.size(), [&](std::size_t i, const Key& key, const std::byte* row) {
    positions[i] = decode_key(key);
    copy_row(rows.data() + i * row_size_, row, row_size_);
  });
}

std::size_t Chunk::read(std::size_t& next, std::span<Key> keys, std::span<std::byte> rows) const {
  const std::size_t first = next;
  const std::size_t n = std::min(keys.size(), size_ - first);
  parallel_for(n, kGrain, [&](std::size_t begin, std::size_t end) {
    get(first + begin, keys.subspan(begin, end - begin),
        rows.subspan(begin * row_size_, (end - begin) * row_size_));
  });
  next += n;
  return n;
}

std::uint64_t Chunk::bytes_per_point(std::size_t row_size) {
  return sizeof(Key) + row_size + sizeof(KeyEntry);
}

std::uint64_t Chunk::sort_bytes_per_point() { return sizeof(KeyEntry) + kSortListBytes; }

}  // namespace pss
