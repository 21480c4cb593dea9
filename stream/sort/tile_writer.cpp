#include "stream/sort/tile_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "stream/sort/encode_blocks.h"
#include "stream/sort/octants.h"
#include "stream/sort/row_ring.h"

namespace pss {
namespace {

std::size_t ring_capacity(const StoreHeader& header, std::uint64_t points) {
  return static_cast<std::size_t>(std::min<std::uint64_t>(header.tile_points, points) + 1);
}

class TileCutter {
 public:
  TileCutter(SortedStream& in, const StoreHeader& header, std::uint64_t points, StoreWriter& store,
             Monitor& monitor, const SyncSizes& sync)
      : in_(in),
        header_(header),
        store_(store),
        monitor_(monitor),
        ring_(ring_capacity(header, points), header.schema.row_size()),
        commit_every_(sync.commit),
        early_sync_(sync.early) {}

  /// Drops the points that the store already has.
  Result<void> skip(std::uint64_t count) {
    while (count > 0) {
      PSS_TRY(check_stopping());
      const auto keys = ring_.free_keys();
      const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(count, keys.size()));
      PSS_ASSIGN(const std::size_t got, in_.read(keys.first(most), ring_.free_rows()));
      if (got == 0)
        return Error{Fault::kFailed,
                     fmt::format("{}: holds {} points more than its inputs; use --restart",
                                 store_.path(), count)};
      count -= got;
      last_ = keys[got - 1];
    }
    return {};
  }

  Result<void> run() {
    PSS_TRY(fill());
    while (ring_.size() > 0) {
      PSS_TRY(write_tile());
      PSS_TRY(fill());
    }
    return store_.sync();
  }

 private:
  Result<void> check_stopping() const {
    if (!monitor_.stopping()) return {};
    return Error{Fault::kInterrupted, "stopped while writing tiles"};
  }

  /// Tops the ring up, as far as there are points: tile_points and the one that is too many.
  Result<void> fill() {
    while (!ended_ && ring_.room() > 0) {
      PSS_TRY(check_stopping());
      PSS_ASSIGN(const std::size_t got, in_.read(ring_.free_keys(), ring_.free_rows()));
      ended_ = got == 0;
      ring_.push(got);
    }
    return {};
  }

  Result<void> write_tile() {
    const std::size_t most = header_.tile_points;
    const Key* beyond = ring_.size() > most ? &ring_.key(most) : nullptr;
    const Cell cell =
        cell_of(ring_.key(0), leaf_level(ring_.key(0), last_ ? &*last_ : nullptr, beyond));
    const std::size_t count = count_within(cell, std::min(ring_.size(), most));
    PSS_TRY(encode_blocks(
        header_.schema, count, kBlockPoints,
        [&](std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) {
          ring_.get(begin, positions, rows);
        },
        [&](const EncodedBlock& block) { return store_.append(block); }, monitor_));
    PSS_TRY(store_.commit_tile(cell, store_.next_source(), {},
                               store_.unsynced_bytes() >= commit_every_));
    const TileInfo& tile = store_.tiles().back();
    early_sync_.grown(segment_path(store_.path(), tile.segment), tile.offset + tile.size);
    last_ = ring_.key(count - 1);
    ring_.pop(count);
    monitor_.advance(count, 1);
    return {};
  }

  /// How many of the first `most` points lie in the cell; they are in order.
  std::size_t count_within(const Cell& cell, std::size_t most) const {
    std::size_t low = 1;  // the first always does
    std::size_t high = most;
    while (low < high) {
      const std::size_t middle = (low + high + 1) / 2;
      contains(cell, ring_.key(middle - 1)) ? low = middle : high = middle - 1;
    }
    return low;
  }

  SortedStream& in_;
  const StoreHeader& header_;
  StoreWriter& store_;
  Monitor& monitor_;
  RowRing ring_;
  std::uint64_t commit_every_;
  EarlySync early_sync_;
  bool ended_ = false;
  std::optional<Key> last_;  ///< of the tile before
};

}  // namespace

TileStart resume_point(const StoreWriter& store) {
  const auto tiles = store.tiles();
  if (tiles.empty()) return {};
  // Tiles of one position share their cell; the points before it are those before their first.
  std::size_t first = tiles.size() - 1;
  while (first > 0 && tiles[first - 1].cell == tiles[first].cell) --first;
  return {tiles[first].cell.first, tiles[first].first_row};
}

Result<void> write_tiles(SortedStream& in, const StoreHeader& header, std::uint64_t points,
                         StoreWriter& store, Monitor& monitor, const SyncSizes& sync) {
  TileCutter cutter(in, header, points, store, monitor, sync);
  PSS_TRY(cutter.skip(store.points() - resume_point(store).rows));
  auto result = cutter.run();
  // What is committed shall not be merged again.
  if (!result && result.error().fault == Fault::kInterrupted) PSS_TRY(store.sync());
  return result;
}

std::uint64_t tile_writer_memory(const StoreHeader& header, std::uint64_t points) {
  const std::uint64_t row = sizeof(Key) + header.schema.row_size();
  // Leaves are about half full on surfaces, a third for good measure; their table may be growing.
  const std::uint64_t tiles = points / header.tile_points * 3 + 8;
  return ring_capacity(header, points) * row +
         encode_blocks_memory(header.schema, std::min<std::size_t>(kBlockPoints, points)) +
         2 * tiles * sizeof(TileInfo);
}

}  // namespace pss
