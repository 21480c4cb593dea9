#include "stream/sort/ingest_memory.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "stream/sort/chunk.h"
#include "stream/sort/encode_blocks.h"
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
std::uint64_t chunk_of(std::uint64_t most_that_fit, std::uint64_t points, std::uint64_t least) {
  if (most_that_fit >= points) return points;
  return std::min(most_that_fit,
                  std::max<std::uint64_t>({kUsualChunk, 2 * points / kLargestFanIn, least}));
}

/// Beside a chunk's points.
std::uint64_t reading_memory(const Schema& schema, const Batches& batches) {
  return kReaderBytes + input_memory(schema, batches) +
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

/// Room for a batch beyond the smallest number of points that is worth sorting.
std::uint64_t least_chunk(const Batches& batches) { return kSmallestChunk + batches.points; }

/// What reading into the smallest chunk takes.
std::uint64_t least_reading(const Schema& schema, const Batches& batches) {
  return reading_memory(schema, batches) + least_chunk(batches) * memory_per_point(schema);
}

/// As many whole units as `points` hold, or one.
std::size_t whole_units(std::size_t points, std::size_t unit) {
  return std::max(points / unit * unit, unit);
}

/// The least that reading goes with. Of large units one at a time must do, decoded by one thread.
Batches least_batches(std::size_t unit) {
  return {whole_units(kSmallestBatch, unit), unit > kSmallestBatch ? 1 : slots_in_order()};
}

/// As much as the caches like, but so that the smallest chunk fits where it can; of large units so
/// many that most of the memory is left to the chunk.
Batches batches_for(const Schema& schema, std::size_t unit, std::uint64_t usable) {
  const std::size_t slots = slots_in_order();
  const Batches least = least_batches(unit);
  const std::uint64_t liked = usable / 32 / input_memory(schema, {1, slots});
  Batches batches{whole_units(std::clamp<std::size_t>(liked, kSmallestBatch, kLargestBatch), unit),
                  slots};
  while (batches.count > least.count &&
         (input_memory(schema, batches) > usable / 4 || least_reading(schema, batches) > usable))
    --batches.count;
  return least_reading(schema, batches) <= usable ? batches : least;
}

/// For a refusal.
std::string sorting(std::size_t unit) {
  if (unit <= kLargestBatch) return "sorting the input";
  return fmt::format("sorting the input, {} records of which are decoded together,", unit);
}

}  // namespace

Result<IngestMemory> divide_memory(const StoreHeader& header, std::uint64_t points,
                                   std::size_t unit, const MemoryBudget& budget) {
  const std::uint64_t least = least_ingest_memory(header, points, unit);
  if (least > budget.available()) return budget.refusal(sorting(unit), least);
  const std::uint64_t usable = usable_of(budget.available());
  const std::uint64_t most = std::max<std::uint64_t>(points, kSmallestChunk);
  IngestMemory memory;
  memory.batches = batches_for(header.schema, unit, usable);
  const std::uint64_t fixed = reading_memory(header.schema, memory.batches);
  const std::uint64_t point = memory_per_point(header.schema);
  memory.chunk_points = chunk_of(std::min<std::uint64_t>((usable - fixed) / point, kLargestChunk),
                                 most + memory.batches.points, least_chunk(memory.batches));
  memory.read_bytes = fixed + memory.chunk_points * point;
  memory.tile_bytes = tiles_memory(header, points);
  const std::uint64_t source = merge_source_memory(header.schema, kRunBlockPoints);
  memory.fan_in = std::min<std::uint64_t>((usable - memory.tile_bytes) / source, kLargestFanIn);
  memory.merge_bytes = usable;
  return memory;
}

std::uint64_t least_ingest_memory(const StoreHeader& header, std::uint64_t points,
                                  std::size_t unit) {
  const std::uint64_t reading = least_reading(header.schema, least_batches(unit));
  const std::uint64_t merging =
      tiles_memory(header, points) + 2 * merge_source_memory(header.schema, kRunBlockPoints);
  return with_the_rest(std::max(reading, merging));
}

}  // namespace pss
