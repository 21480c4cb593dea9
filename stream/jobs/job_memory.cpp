#include "stream/jobs/job_memory.h"

#include <algorithm>
#include <utility>

#include "io/file/file.h"
#include "stream/sort/ingest_memory.h"
#include "stream/store/block.h"
#include "stream/store/export.h"
#include "stream/store/store.h"

namespace pss {
namespace {

LeastMemory least_of(const JobRequest& request, const JobKind& kind) {
  return [&request, &kind](const StoreHeader& header, std::uint64_t points, std::size_t unit) {
    return least_job_memory(request, kind, header, points, unit);
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

/// Of measuring and of passes, with their tables; none where the sorted input is the result.
std::uint64_t computing_memory(const JobKind& kind, const StoreHeader& sorted, std::size_t row,
                               std::uint64_t points) {
  if (kind.passes().names.empty()) return 0;
  return std::max(kind.measuring_memory(), block_memory(row, points)) +
         tables_memory(sorted.tile_points, points);
}

}  // namespace

std::uint64_t least_job_memory(const JobRequest& request, const JobKind& kind,
                               const StoreHeader& header, std::uint64_t points, std::size_t unit) {
  StoreHeader sorted = header;
  sorted.tile_points = request.tile_points;
  const Result<Schema> result = kind.result_schema(header.schema);
  const std::size_t row = (result ? *result : header.schema).row_size();
  const std::uint64_t sorting =
      is_store_input(request) ? 0 : least_ingest_memory(sorted, points, unit);
  const std::uint64_t writing = is_store_name(request.output) ? 0 : export_memory(row, points);
  return std::max({sorting, writing, computing_memory(kind, sorted, row, points)});
}

Result<Reservation> reserve_inputs(const JobRequest& request, const JobKind& kind,
                                   MemoryBudget& budget) {
  if (!is_store_input(request))
    return reserve_inputs(request.inputs, least_of(request, kind), budget);
  PSS_ASSIGN(Reservation header, reserve_header_and_head(request.inputs.front(), budget));
  PSS_ASSIGN(const Store store, Store::open(request.inputs.front()));
  const std::uint64_t bytes = memory_of(store.header());
  if (!budget.grow(header, bytes))
    return budget.refusal(store.path() + ": the header", bytes - header.bytes());
  PSS_TRY(check_least(request, kind, store.header(), store.points(), 1, budget));
  return header;
}

Result<void> check_least(const JobRequest& request, const JobKind& kind, const StoreHeader& header,
                         std::uint64_t points, std::size_t unit, const MemoryBudget& budget) {
  return check_least(header, points, unit, least_of(request, kind), budget);
}

}  // namespace pss
