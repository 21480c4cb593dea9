#include "stream/disk_need.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/file.h"
#include "stream/chunk.h"
#include "stream/input_stream.h"

namespace pss {
namespace {

constexpr std::size_t kSamplePoints = 4 * kBlockPoints;

double row_bytes(const Schema& schema) {
  // Checksums and indexes add well under two percent.
  return 1.02 * static_cast<double>(sizeof(Index3) + schema.row_size());
}

/// Bytes a point of the first points of the input take, compressed.
Result<double> sample_bytes(const IngestPlan& plan, const Monitor& monitor) {
  InputStream in(plan, false, {}, {});
  Chunk chunk(kSamplePoints, plan.header.schema.row_size());
  KeyedRows batch;
  while (!in.ended() && chunk.room() > 0) {
    PSS_TRY(in.read(std::min<std::size_t>(chunk.room(), 1024), batch));
    chunk.add(batch.keys, batch.rows);
  }
  if (chunk.size() == 0) return 0.0;
  PSS_TRY(chunk.sort(monitor));
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < chunk.size(); i += kBlockPoints) {
    const std::size_t n = std::min<std::size_t>(kBlockPoints, chunk.size() - i);
    std::vector<Index3> positions(n);
    std::vector<std::byte> rows(n * chunk.row_size());
    chunk.get(i, positions, rows);
    bytes += encode_block(plan.header.schema, positions, rows).bytes.size();
  }
  // A sample is a sample: an eighth more.
  return 1.125 * static_cast<double>(bytes) / static_cast<double>(chunk.size());
}

struct Room {
  double runs = 0;
  double store = 0;
  bool shared = false;  ///< both on one disk, as far as equal free space tells

  bool fits(double run_bytes, double store_bytes) const {
    return shared ? run_bytes + store_bytes <= store : run_bytes <= runs && store_bytes <= store;
  }
};

Result<Room> free_room(const std::string& store_path, const std::string& work_dir) {
  PSS_ASSIGN(const std::uint64_t store, free_space(directory_of(store_path)));
  PSS_ASSIGN(const std::uint64_t runs, free_space(work_dir));
  return Room{static_cast<double>(runs), static_cast<double>(store), runs == store};
}

}  // namespace

std::uint64_t disk_bound(const Schema& schema, std::uint64_t points) {
  return static_cast<std::uint64_t>(2 * row_bytes(schema) * static_cast<double>(points));
}

Result<void> check_disk(const IngestPlan& plan, const DiskWork& work, const std::string& store_path,
                        const std::string& work_dir, const Monitor& monitor) {
  PSS_ASSIGN(const Room room, free_room(store_path, work_dir));
  const auto needed = [&](double per_point, std::uint64_t points) {
    return per_point * static_cast<double>(points);
  };
  double per_point = row_bytes(plan.header.schema);
  if (room.fits(needed(per_point, work.run_points), needed(per_point, work.store_points)))
    return {};
  PSS_ASSIGN(per_point, sample_bytes(plan, monitor));
  const double runs = needed(per_point, work.run_points);
  const double store = needed(per_point, work.store_points);
  if (room.fits(runs, store)) return {};
  return Error{Fault::kFailed,
               fmt::format("the disk is too full: about {:.0f} MB for sorted runs in {} ({:.0f} MB "
                           "free) and {:.0f} MB for {} ({:.0f} MB free) are needed; make room or "
                           "choose another --work-dir",
                           runs / 1e6, work_dir, room.runs / 1e6, store / 1e6, store_path,
                           room.store / 1e6)};
}

}  // namespace pss
