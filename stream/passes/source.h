#pragma once
// The points of a store as passes and measurements see them: rows, joined columns, who counts.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/points/schema.h"
#include "stream/passes/exclusion.h"
#include "stream/store/store.h"

namespace pss {

/// A store, with the columns that earlier passes computed for its rows.
///
/// Tiles are given by their number in the store. Views the stores, which outlive it.
///
/// Thread: const members from any number at once.
class Source {
 public:
  Source(const Store& store);  // NOLINT(google-explicit-constructor): a store alone is a source

  /// Adds the columns of a store that an operator of columns alone made of this one: its rows go
  /// with the rows here, tile by tile.
  ///
  /// Errors: kBadInput where a tile there has another number of points than the tile here.
  Result<void> join(const Store& columns);

  const Store& store() const { return *store_; }
  const std::string& path() const { return store_->path(); }
  const StoreHeader& header() const { return store_->header(); }
  const Lattice& lattice() const { return store_->header().lattice; }
  std::span<const TileInfo> tiles() const { return store_->tiles(); }
  std::uint64_t points() const { return store_->points(); }
  /// The store's fields, then those of the joined columns.
  const Schema& schema() const { return schema_; }

  Result<std::vector<BlockInfo>> read_index(std::size_t tile) const {
    return store_->read_index(tile);
  }
  /// Shape: `out` has block.count elements.
  Result<void> read_positions(std::size_t tile, const BlockInfo& block,
                              std::span<Index3> out) const {
    return store_->read_positions(tiles()[tile], block, out);
  }
  /// One field of schema(). Shape: block.count * field size bytes.
  ///
  /// Errors: those of Store; kBadInput where the tile has no joined columns.
  Result<void> read_field(std::size_t tile, const BlockInfo& block, std::size_t field,
                          std::span<std::byte> out) const;
  /// Rows of schema(). Shape: block.count * row_size bytes. Errors: those of read_field().
  Result<void> read_rows(std::size_t tile, const BlockInfo& block, std::span<std::byte> out) const;

  /// Marks the points of a block that are no neighbours of others. Shape: block.count elements.
  Result<void> mark_excluded(std::size_t tile, const BlockInfo& block,
                             std::span<std::uint8_t> excluded) const;
  /// Replaces `positions` by those of the block's points that may be neighbours, in row order.
  Result<void> read_neighbours(std::size_t tile, const BlockInfo& block,
                               std::vector<Index3>& positions) const;
  /// Whether any point of the store can be excluded.
  bool excludes_some() const { return exclusion_.active(); }

 private:
  /// Columns that go with the rows of the store.
  struct Joined {
    const Store* store;
    std::size_t first_field;  ///< of schema_
    std::size_t position;     ///< in a row of schema_
  };
  /// A block of joined columns, and its tile there.
  struct Place {
    std::size_t tile;
    BlockInfo block;
  };
  Result<Place> find(const Joined& joined, std::size_t tile, const BlockInfo& block) const;
  Result<void> add_rows(const Joined& joined, std::size_t tile, const BlockInfo& block,
                        std::span<std::byte> out) const;

  const Store* store_;
  Exclusion exclusion_;
  Schema schema_;
  std::vector<Joined> joined_;
};

}  // namespace pss
