#pragma once
// A store opened to read: a directory of tiles, each a sequence of compressed blocks of points.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/morton.h"
#include "core/result.h"
#include "io/file/fingerprint.h"
#include "io/points/points.h"
#include "io/points/schema.h"
#include "stream/store/block.h"
#include "stream/store/manifest.h"
#include "stream/store/segment_files.h"

namespace pss {

/// A store opened to read.
///
/// Thread: any number at once for const members.
/// Errors: kBadInput, with file and offset, where bytes do not match their hash; kFailed where the
///         manifest of a complete store has changed, so that they cannot match.
class Store {
 public:
  static Result<Store> open(const std::string& path);

  const std::string& path() const { return path_; }
  const StoreHeader& header() const { return manifest_.header; }
  std::span<const TileInfo> tiles() const { return manifest_.tiles; }
  std::uint64_t points() const { return manifest_.points(); }
  /// Whether the writer finished it, and the JSON it left then (points dropped by reason, ...).
  bool complete() const { return manifest_.complete; }
  const std::string& summary() const { return manifest_.summary; }
  /// What the writer says of the whole store, once it is complete: see bytes_of().
  const Note& note() const { return manifest_.note; }
  /// The program that made it, with its version.
  const std::string& producer() const { return manifest_.producer; }
  std::uint64_t bytes_on_disk() const;
  /// What the tile table holds in memory; memory_of() tells that of the header.
  std::uint64_t table_memory() const;

  /// What is kept of each input. Requires: complete(), and a header with inputs.
  Result<InputTable> inputs() const;

  /// The blocks of a tile, in row order; none where it is empty.
  Result<std::vector<BlockInfo>> read_index(std::size_t tile) const;
  /// Reads a tile's bytes against their checksums, decoding none. Errors: kBadInput.
  Result<void> check_bytes(std::size_t tile) const;
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
  Result<void> open_files();
  Result<void> open_segments();
  Result<void> check_inputs() const;
  Result<void> read_segment(const TileInfo& tile, std::uint64_t offset,
                            std::span<std::byte> out) const;
  Error changed_or(Error error) const;
  Result<void> check_column(const TileInfo& tile, const ColumnInfo& column,
                            std::span<const std::byte> bytes) const;
  Result<std::vector<std::byte>> read_column(const TileInfo& tile, const ColumnInfo& column) const;
  Error damaged(const TileInfo& tile, std::uint64_t offset, const std::string& what) const;
  std::string path_;
  Manifest manifest_;
  std::optional<InputRecord> record_;  ///< of a complete store's manifest, before it was read
  std::uint64_t manifest_size_ = 0;
  std::unique_ptr<SegmentFiles> segments_;
};

/// The bytes of a tile's index, as StoreWriter appends them after its blocks.
std::vector<std::byte> encode_index(std::span<const BlockInfo> blocks);

}  // namespace pss

#include "stream/store/store_writer.h"
