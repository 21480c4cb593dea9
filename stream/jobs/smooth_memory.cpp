#include "stream/jobs/smooth_memory.h"

#include <algorithm>
#include <utility>

#include "io/file/file.h"
#include "stream/jobs/smooth_job.h"
#include "stream/passes/outputs.h"
#include "stream/sort/ingest_memory.h"
#include "stream/store/block.h"
#include "stream/store/export.h"
#include "stream/store/store.h"
#include "stream/widths/width_trials.h"
#include "stream/widths/widths.h"

namespace pss {
namespace {

LeastMemory least_of(const SmoothJob& job) {
  return [&job](const StoreHeader& header, std::uint64_t points) {
    return least_smooth_memory(job, header, points);
  };
}

/// The smallest part: a block whose rows are held as they are and compressed.
std::uint64_t block_memory(std::size_t row, std::uint64_t points) {
  return std::min<std::uint64_t>(points, kBlockPoints) *
         (2 * (sizeof(Index3) + row) + row / 64 + 1);
}

/// Of a sorted input and of what is made of it; tiles are a third full at worst.
std::uint64_t tables_memory(std::uint32_t tile_points, std::uint64_t points) {
  return 2 * (points / tile_points * 3 + 8) * sizeof(TileInfo);
}

}  // namespace

std::uint64_t least_smooth_memory(const SmoothJob& job, const StoreHeader& header,
                                  std::uint64_t points) {
  StoreHeader sorted = header;
  sorted.tile_points = job.options.tile_points;
  Schema result = header.schema;
  static_cast<void>(OutputColumns::add_to(result, job.options.outputs).has_value());  // or as it is
  const std::size_t row = result.row_size();
  const std::uint64_t sorting = is_store_input(job) ? 0 : least_ingest_memory(sorted, points);
  const std::uint64_t widths = needs_spacing(job.options.widths) ? width_memory() : 0;
  const std::uint64_t writing = is_store_name(job.output) ? 0 : export_memory(row, points);
  const std::uint64_t computing = std::max(widths, block_memory(row, points));
  return std::max({sorting, writing, computing + tables_memory(sorted.tile_points, points)});
}

Result<Reservation> reserve_inputs(const SmoothJob& job, MemoryBudget& budget) {
  if (!is_store_input(job)) return reserve_inputs(job.inputs, least_of(job), budget);
  PSS_ASSIGN(Reservation header, reserve_header_and_head(job.inputs.front(), budget));
  PSS_ASSIGN(const Store store, Store::open(job.inputs.front()));
  const std::uint64_t bytes = memory_of(store.header());
  if (!budget.grow(header, bytes))
    return budget.refusal(store.path() + ": the header", bytes - header.bytes());
  PSS_TRY(check_least(job, store.header(), store.points(), budget));
  return header;
}

Result<void> check_least(const SmoothJob& job, const StoreHeader& header, std::uint64_t points,
                         const MemoryBudget& budget) {
  return check_least(header, points, least_of(job), budget);
}

}  // namespace pss
