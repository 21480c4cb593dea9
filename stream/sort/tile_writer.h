#pragma once
// Cuts a sorted sequence into tiles and writes them to a store.

#include <cstdint>
#include <optional>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/sort/early_sync.h"
#include "stream/sort/sorted_stream.h"
#include "stream/store/store_writer.h"

namespace pss {

/// Where a sequence may begin so that a store with some tiles goes on: `key` is the first key of
/// the last tile's cell, and `rows` points of the store come before all points from `key` on.
struct TileStart {
  std::optional<Key> key;
  std::uint64_t rows = 0;
};

TileStart resume_point(const StoreWriter& store);

/// Appends the tiles of a sequence that begins at resume_point(store), up to its end.
///
/// The tiles are those of the whole sequence, whatever the store already has: a pure function of
/// the points and of header.tile_points.
/// Shape:  `points` is how many there are in all.
/// Errors: kInterrupted, leaving whole tiles; kFailed where the sequence is shorter than the store.
Result<void> write_tiles(SortedStream& in, const StoreHeader& header, std::uint64_t points,
                         StoreWriter& store, Monitor& monitor, const SyncSizes& sync);

/// What write_tiles holds at most.
std::uint64_t tile_writer_memory(const StoreHeader& header, std::uint64_t points);

}  // namespace pss
