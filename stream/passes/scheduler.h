#pragma once
// Streams every tile of a source, with its halo, through an operator into a result store.

#include <cstdint>
#include <span>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/operator.h"
#include "stream/passes/schedule_summary.h"
#include "stream/store/store_writer.h"

namespace pss {

/// Runs `op` over all tiles of the queries that `result` does not have yet.
///
/// One part is computed by all threads while the next ones are loaded and the last are compressed
/// and written; a part is admitted only when its whole memory fits in the budget, and a tile that
/// does not fit is done in parts. The rows are the same however tiles are cut into parts.
///
/// Errors: kMemoryLimit where a single block with its halo does not fit, with place, density and
///         the limit that would do; kInterrupted when the monitor stops: `result` is resumable.
Result<ScheduleSummary> run_operator(const PassSources& sources, const Operator& op,
                                     StoreWriter& result, MemoryBudget& budget, Monitor& monitor);

/// The notes of all tiles of the result `store`, merged in their order: what a pass is asked for
/// that measures something of the whole source.
///
/// Errors: kBadInput where a tile's note is of another version than the operator's.
Result<Note> merged_notes(const Operator& op, std::span<const TileInfo> tiles,
                          const std::string& store);

/// What run_operator would do, from the block indexes alone.
struct ScheduleEstimate {
  std::uint64_t tiles = 0;
  std::uint64_t parts = 0;
  std::uint64_t own_points = 0;
  std::uint64_t halo_points = 0;  ///< at most: whole blocks are counted
  std::uint64_t peak_bytes = 0;   ///< of parts in flight
};
Result<ScheduleEstimate> estimate_operator(const PassSources& sources, const Operator& op,
                                           MemoryBudget& budget);

}  // namespace pss
