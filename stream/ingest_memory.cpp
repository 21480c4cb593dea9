#include "stream/ingest_memory.h"

#include <fmt/format.h>

#include <algorithm>

#include "stream/chunk.h"
#include "stream/encode_blocks.h"
#include "stream/input_stream.h"
#include "stream/merge.h"
#include "stream/tile_writer.h"

namespace pss {
namespace {

constexpr std::uint64_t kMiB = 1 << 20;
/// A reader's own buffers.
constexpr std::uint64_t kReaderBytes = 2 * kMiB;
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

std::uint64_t divide(std::uint64_t bytes, std::uint64_t by) { return by > 0 ? bytes / by : 0; }

Error too_small(const MemoryBudget& budget, std::uint64_t usable, std::uint64_t needed) {
  const std::uint64_t missing = needed + needed / 16 - std::min(needed, usable);
  return {Fault::kMemoryLimit,
          fmt::format("sorting the input needs {} MiB of memory at least, {} MiB are left; use "
                      "--memory-limit {}M or more",
                      needed / kMiB + 1, usable / kMiB, (budget.limit() + missing) / kMiB + 1)};
}

}  // namespace

Result<IngestMemory> divide_memory(const StoreHeader& header, std::uint64_t points,
                                   const MemoryBudget& budget) {
  // A sixteenth is left for what nobody counts: paths, small vectors, the allocator's rounding.
  const std::uint64_t usable = budget.available() - budget.available() / 16;
  const std::uint64_t most = std::max<std::uint64_t>(points, kSmallestChunk);
  IngestMemory memory;

  const std::uint64_t batch_point = input_bytes_per_point(header.schema);
  memory.batch_points =
      std::clamp<std::size_t>(usable / 32 / batch_point, kSmallestBatch, kLargestBatch);
  const std::uint64_t fixed = kReaderBytes + memory.batch_points * batch_point +
                              encode_blocks_memory(header.schema, kRunBlockPoints);
  const std::uint64_t point =
      Chunk::bytes_per_point(header.schema.row_size()) + Chunk::sort_bytes_per_point();
  const std::uint64_t chunk = usable > fixed ? divide(usable - fixed, point) : 0;
  memory.chunk_points =
      chunk_of(std::min<std::uint64_t>(chunk, kLargestChunk), most + memory.batch_points);
  memory.read_bytes = fixed + memory.chunk_points * point;
  if (chunk < kSmallestChunk + memory.batch_points)
    return too_small(budget, usable, fixed + (kSmallestChunk + memory.batch_points) * point);

  const std::uint64_t tiles =
      tile_writer_memory(header, points) + merge_decode_memory(header.schema);
  const std::uint64_t source = merge_source_memory(header.schema, kRunBlockPoints);
  const std::uint64_t fan_in = usable > tiles ? divide(usable - tiles, source) : 0;
  if (fan_in < 2) return too_small(budget, usable, tiles + 2 * source);
  memory.fan_in = std::min<std::uint64_t>(fan_in, kLargestFanIn);
  memory.tile_bytes = tiles;
  memory.merge_bytes = usable;
  return memory;
}

}  // namespace pss
