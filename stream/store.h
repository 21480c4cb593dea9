#pragma once
// A store: a directory of tiles, each a sequence of compressed blocks of points.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/morton.h"
#include "core/result.h"
#include "io/file.h"
#include "io/points.h"
#include "io/schema.h"

namespace pss {

inline constexpr std::uint32_t kTilePoints = 1u << 18;  ///< a tile owns at most so many points
inline constexpr std::uint32_t kBlockPoints = 4096;     ///< a block holds at most so many

/// A file that points came from, as far as it tells whether it is still the same.
struct InputRecord {
  std::string path;
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;
  std::uint64_t content_hash = 0;  ///< of its first and last 64 KiB

  bool operator==(const InputRecord&) const = default;
};

/// What is known before the first tile: the manifest's first record.
struct StoreHeader {
  Lattice lattice;
  Schema schema;
  std::uint32_t tile_points = kTilePoints;
  bool ordered =
      true;  ///< rows in key order; false for results, whose rows keep their source's order
  std::optional<Lattice> grid;  ///< scale and offset that a LAS file written from this gets
  Carry carry;                  ///< header of the first input, for a file of the same format
  Format source_format = Format::kLas;
  std::string crs;
  std::vector<InputRecord> inputs;
  std::string parameters;  ///< JSON: what made the rows, beyond the inputs

  bool operator==(const StoreHeader&) const = default;
};

/// What a tile's manifest record says.
struct TileInfo {
  Cell cell;
  std::uint64_t first_row = 0;
  std::uint64_t count = 0;
  IndexBox box;  ///< measured over its rows; those of a result may leave the cell
  std::uint32_t blocks = 0;
  std::uint32_t segment = 0;
  std::uint64_t offset = 0;  ///< of its first block in the segment
  std::uint64_t size = 0;    ///< blocks and block index together
  std::uint32_t index_size = 0;
  std::uint64_t index_hash = 0;
  std::vector<std::byte> note;  ///< of whoever wrote the tile: an operator's statistics
};

/// A column of a block: where its compressed bytes are in the segment, and their hash.
struct ColumnInfo {
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  std::uint64_t hash = 0;
};

/// A block's entry in its tile's index. Column 0 is the position, column 1 + f is field f.
struct BlockInfo {
  std::uint32_t count = 0;
  std::uint64_t first_row = 0;
  IndexBox box;
  std::vector<ColumnInfo> columns;
};

/// A compressed block on its way to a store, made by any thread.
struct EncodedBlock {
  std::uint32_t count = 0;
  IndexBox box;
  std::vector<std::byte> bytes;
  std::vector<ColumnInfo> columns;  ///< offsets relative to `bytes`
};

/// Compresses up to kBlockPoints rows.
///
/// Shape:  `positions` n, `rows` n * schema.row_size() bytes.
/// Thread: any number at once.
EncodedBlock encode_block(const Schema& schema, std::span<const Index3> positions,
                          std::span<const std::byte> rows);

/// A store opened to read.
///
/// Thread: any number at once for const members.
/// Errors: kBadInput, with file and offset, where bytes do not match their hash.
class Store {
 public:
  static Result<Store> open(const std::string& path);

  const std::string& path() const { return path_; }
  const StoreHeader& header() const { return header_; }
  std::span<const TileInfo> tiles() const { return tiles_; }
  std::uint64_t points() const;
  /// Whether the writer finished it, and the JSON it left then (points dropped by reason, ...).
  bool complete() const { return complete_; }
  const std::string& summary() const { return summary_; }
  std::uint64_t bytes_on_disk() const;
  /// What the tile table itself holds in memory.
  std::uint64_t memory() const;

  Result<std::vector<BlockInfo>> read_index(std::size_t tile) const;
  /// Shape: `out` has block.count elements.
  Result<void> read_positions(const TileInfo& tile, const BlockInfo& block,
                              std::span<Index3> out) const;
  /// One field of every row of the block, densely. Shape: block.count * field size bytes.
  Result<void> read_field(const TileInfo& tile, const BlockInfo& block, std::size_t field,
                          std::span<std::byte> out) const;
  /// Whole rows. Shape: block.count * row_size bytes.
  Result<void> read_rows(const TileInfo& tile, const BlockInfo& block,
                         std::span<std::byte> out) const;

 private:
  Store() = default;
  friend class StoreWriter;
  std::string path_;
  StoreHeader header_;
  std::vector<TileInfo> tiles_;
  std::vector<File> segments_;
  bool complete_ = false;
  std::string summary_;
};

/// Appends tiles to a store, durably, one at a time.
///
/// Thread: one.
class StoreWriter {
 public:
  /// Starts a new store; what was at `path` is removed.
  static Result<StoreWriter> create(const std::string& path, const StoreHeader& header);
  /// Goes on with a store whose header equals `header`: cuts the torn tail of the manifest and
  /// unrecorded segment bytes. Errors: kFailed where the headers differ, kBadInput where damaged.
  static Result<StoreWriter> resume(const std::string& path, const StoreHeader& header);

  std::span<const TileInfo> tiles() const { return tiles_; }
  bool complete() const { return complete_; }

  /// Appends a block of the tile that is being written.
  Result<void> append(const EncodedBlock& block);
  /// Ends the tile: index, fdatasync of the segment, manifest record, fdatasync.
  ///
  /// Tiles may share the syncs: with `sync` false they become durable at the next commit with true.
  Result<void> commit_tile(const Cell& cell, std::vector<std::byte> note = {}, bool sync = true);
  /// Ends the store. `summary` is JSON that readers find in Store::summary().
  Result<void> finish(const std::string& summary);

 private:
  StoreWriter() = default;
  std::string path_;
  StoreHeader header_;
  std::vector<TileInfo> tiles_;
  bool complete_ = false;
  std::optional<File> manifest_;
  std::uint64_t manifest_size_ = 0;
  std::optional<File> segment_;
  std::uint32_t segment_number_ = 0;
  std::uint64_t segment_size_ = 0;
  std::vector<BlockInfo> blocks_;  ///< of the tile that is being written
  std::uint64_t next_row_ = 0;
};

}  // namespace pss
