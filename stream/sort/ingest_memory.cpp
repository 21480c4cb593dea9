#include "stream/sort/ingest_memory.h"

#include <algorithm>

#include "stream/sort/chunk.h"
#include "stream/sort/encode_blocks.h"
#include "stream/sort/input_stream.h"
#include "stream/sort/merge.h"
#include "stream/sort/tile_writer.h"

namespace pss {
namespace {

/// A reader's own buffers.
constexpr std::uint64_t kReaderBytes = 2 << 20;
constexpr std::size_t kSmallestBatch = 64;
/// More would leave the caches between decoding and placing.
constexpr std::size_t kLargestBatch = 1 << 13;
constexpr std::size_t kSmallestChunk = 4096;
/// A row's number in a chunk has 32 bits.
constexpr std::size_t kLargestChunk = std::size_t{1} << 31;
/// Longer runs are sorted no faster, and what they hold the page cache lacks.
constexpr std::size_t kUsualChunk = std::size_t{1} << 24;
/// Open files at once; also far beyond where wider merges gain anything.
constexpr std::size_t kLargestFanIn = 256;

/// All points where they fit; else no more than sort well and leave a merge of all runs at once.
std::uint64_t chunk_of(std::uint64_t most_that_fit, std::uint64_t points) {
  if (most_that_fit >= points) return points;
  return std::min(most_that_fit, std::max<std::uint64_t>(kUsualChunk, 2 * points / kLargestFanIn));
}

/// Beside a chunk's points, where so many are read at once.
std::uint64_t reading_memory(const Schema& schema, std::size_t batch_points) {
  return kReaderBytes + batch_points * input_bytes_per_point(schema) +
         encode_blocks_memory(schema, kRunBlockPoints);
}

std::uint64_t memory_per_point(const Schema& schema) {
  return Chunk::bytes_per_point(schema.row_size()) + Chunk::sort_bytes_per_point();
}

std::uint64_t tiles_memory(const StoreHeader& header, std::uint64_t points) {
  return tile_writer_memory(header, points) + merge_decode_memory(header.schema);
}

/// A sixteenth is left for what nobody counts: paths, small vectors, the allocator's rounding.
std::uint64_t usable_of(std::uint64_t bytes) { return bytes - bytes / 16; }

/// The least of which usable_of() is that much.
std::uint64_t with_the_rest(std::uint64_t usable) { return usable + usable / 15 + 1; }

/// As much as the caches like, but so that the smallest chunk fits where it can.
std::size_t batch_for(const Schema& schema, std::uint64_t usable) {
  const std::size_t batch = std::clamp<std::size_t>(usable / 32 / input_bytes_per_point(schema),
                                                    kSmallestBatch, kLargestBatch);
  const std::uint64_t least =
      reading_memory(schema, batch) + (kSmallestChunk + batch) * memory_per_point(schema);
  return least <= usable ? batch : kSmallestBatch;
}

}  // namespace

Result<IngestMemory> divide_memory(const StoreHeader& header, std::uint64_t points,
                                   const MemoryBudget& budget) {
  if (const std::uint64_t least = least_ingest_memory(header, points); least > budget.available())
    return budget.refusal("sorting the input", least);
  const std::uint64_t usable = usable_of(budget.available());
  const std::uint64_t most = std::max<std::uint64_t>(points, kSmallestChunk);
  IngestMemory memory;
  memory.batch_points = batch_for(header.schema, usable);
  const std::uint64_t fixed = reading_memory(header.schema, memory.batch_points);
  const std::uint64_t point = memory_per_point(header.schema);
  memory.chunk_points = chunk_of(std::min<std::uint64_t>((usable - fixed) / point, kLargestChunk),
                                 most + memory.batch_points);
  memory.read_bytes = fixed + memory.chunk_points * point;
  memory.tile_bytes = tiles_memory(header, points);
  const std::uint64_t source = merge_source_memory(header.schema, kRunBlockPoints);
  memory.fan_in = std::min<std::uint64_t>((usable - memory.tile_bytes) / source, kLargestFanIn);
  memory.merge_bytes = usable;
  return memory;
}

std::uint64_t least_ingest_memory(const StoreHeader& header, std::uint64_t points) {
  const std::uint64_t reading = reading_memory(header.schema, kSmallestBatch) +
                                (kSmallestChunk + kSmallestBatch) * memory_per_point(header.schema);
  const std::uint64_t merging =
      tiles_memory(header, points) + 2 * merge_source_memory(header.schema, kRunBlockPoints);
  return with_the_rest(std::max(reading, merging));
}

}  // namespace pss
