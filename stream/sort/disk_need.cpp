#include "stream/sort/disk_need.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "io/file/file.h"
#include "stream/sort/chunk.h"
#include "stream/sort/encode_blocks.h"
#include "stream/sort/input_stream.h"
#include "stream/sort/run.h"

namespace pss {
namespace {

/// A run is seldom smaller, and to sort so many costs little.
constexpr std::uint64_t kSamplePoints = 1 << 18;
/// Few and long, they are as dense as scanners' neighbouring records; many and short, neighbours
/// come from anywhere in the inputs, as where scans overlap.
constexpr std::uint64_t kLongWindows = 16;
constexpr std::uint64_t kShortWindows = 4096;
constexpr std::size_t kBatchPoints = 1024;
/// Where records are decoded together, a window decodes all of them for the few that it takes:
/// there are no more windows than decode so many.
constexpr std::uint64_t kMostDecoded = 1 << 21;
/// A sample is a sample.
constexpr double kMargin = 1.05;

double row_bytes(const Schema& schema) {
  // Checksums and indexes add well under two percent.
  return 1.02 * static_cast<double>(sizeof(Index3) + schema.row_size());
}

/// The place of the `record`-th of all records.
Cursor cursor_at(const IngestPlan& plan, std::uint64_t record) {
  Cursor cursor{0, record};
  while (cursor.input < plan.inputs.size() && cursor.record >= plan.counts[cursor.input])
    cursor.record -= plan.counts[cursor.input++];
  return cursor;
}

/// A window reads one or two of units that are larger than it: more at once would gain nothing.
Batches batches_of(std::size_t unit) {
  return {std::max(kBatchPoints, unit), unit > kBatchPoints ? 1 : slots_in_order()};
}

/// Fills `chunk` from windows of consecutive records, evenly spread over all inputs.
Result<void> read_windows(const IngestPlan& plan, bool source_column, std::uint64_t most,
                          Chunk& chunk, const Monitor& monitor) {
  InputStream in(plan, source_column, {}, {});
  const std::uint64_t affordable = std::max<std::uint64_t>(1, kMostDecoded / plan.unit);
  const std::uint64_t windows = std::min<std::uint64_t>({most, chunk.room(), affordable});
  const std::uint64_t window = windows > 0 ? chunk.room() / windows : 0;
  for (std::uint64_t w = 0; w < windows; ++w) {
    PSS_TRY(in.seek(cursor_at(plan, plan.points * w / windows)));
    const std::size_t full = std::min(chunk.size() + window, chunk.capacity());
    while (chunk.size() < full && !in.ended())
      PSS_TRY(in.read(full - chunk.size(), batches_of(plan.unit), chunk, monitor));
  }
  return {};
}

/// Bytes that the columns of a sorted chunk take a point, compressed; and last what blocks add.
Result<std::vector<double>> column_bytes(const Schema& schema, const Chunk& chunk,
                                         const Monitor& monitor) {
  std::vector<double> bytes;
  const double points = static_cast<double>(chunk.size());
  PSS_TRY(encode_blocks(
      schema, chunk.size(), kRunBlockPoints,
      [&](std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) {
        chunk.get(begin, positions, rows);
      },
      [&](const EncodedBlock& block) -> Result<void> {
        bytes.resize(block.columns.size() + 1);
        for (std::size_t c = 0; c < block.columns.size(); ++c)
          bytes[c] += block.columns[c].size / points;
        const std::size_t head = sizeof(BlockInfo) + block.columns.size() * sizeof(ColumnInfo);
        bytes.back() += static_cast<double>(head) / points;
        return {};
      },
      monitor));
  return bytes;
}

struct Room {
  double runs = 0;
  double store = 0;
  bool shared = false;  ///< both on one disk

  bool fits(double run_bytes, double store_bytes) const {
    return shared ? run_bytes + store_bytes <= store : run_bytes <= runs && store_bytes <= store;
  }
};

Result<Room> free_room(const std::string& store_path, const std::string& work_dir) {
  PSS_ASSIGN(const std::uint64_t store, free_space(directory_of(store_path)));
  PSS_ASSIGN(const std::uint64_t runs, free_space(work_dir));
  return Room{static_cast<double>(runs), static_cast<double>(store),
              same_disk(directory_of(store_path), work_dir)};
}

}  // namespace

Result<double> sample_bytes(const IngestPlan& plan, bool source_column, std::uint64_t chunk_points,
                            const Monitor& monitor) {
  const Schema& schema = plan.header.schema;
  Chunk chunk(static_cast<std::size_t>(std::min({plan.points, kSamplePoints, chunk_points})),
              schema.row_size());
  std::vector<double> columns;
  for (const std::uint64_t windows : {kLongWindows, kShortWindows}) {
    chunk.clear();
    PSS_TRY(read_windows(plan, source_column, windows, chunk, monitor));
    if (chunk.size() == 0) return 0.0;
    PSS_TRY(chunk.sort(monitor));
    PSS_ASSIGN(const std::vector<double> found, column_bytes(schema, chunk, monitor));
    if (columns.empty()) columns = found;
    // No sample is denser than the whole: of positions, the denser one is nearer to it.
    columns[0] = std::min(columns[0], found[0]);
    for (std::size_t c = 1; c < found.size(); ++c) columns[c] = std::max(columns[c], found[c]);
  }
  return kMargin * std::accumulate(columns.begin(), columns.end(), 0.0);
}

Result<void> check_disk(const IngestPlan& plan, const DiskWork& work, const std::string& store_path,
                        const std::string& work_dir, const Monitor& monitor) {
  PSS_ASSIGN(const Room room, free_room(store_path, work_dir));
  const auto needed = [](double per_point, std::uint64_t points) {
    return per_point * static_cast<double>(points);
  };
  // The store keeps the heads of all inputs.
  const double heads = std::accumulate(
      plan.head_sizes.begin(), plan.head_sizes.end(), 0.0,
      [](double sum, std::uint64_t size) { return sum + static_cast<double>(size); });
  double per_point = row_bytes(plan.header.schema);
  if (room.fits(needed(per_point, work.run_points), needed(per_point, work.store_points) + heads))
    return {};
  PSS_ASSIGN(const double sampled,
             sample_bytes(plan, work.source_column, work.chunk_points, monitor));
  per_point = std::min(per_point, sampled);
  const double runs = needed(per_point, work.run_points);
  const double store = needed(per_point, work.store_points) + heads;
  if (room.fits(runs, store)) return {};
  return Error{Fault::kFailed,
               fmt::format("the disk is too full: about {:.0f} MB for sorted runs in {} ({:.0f} MB "
                           "free) and {:.0f} MB for {} ({:.0f} MB free) are needed; make room or "
                           "choose another --work-dir",
                           runs / 1e6, work_dir, room.runs / 1e6, store / 1e6, store_path,
                           room.store / 1e6)};
}

}  // namespace pss
