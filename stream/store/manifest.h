#pragma once
// What a store says of itself: the typed records of its manifest, and their bytes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/lattice.h"
#include "core/morton.h"
#include "core/result.h"
#include "io/points/schema.h"
#include "stream/store/input_table.h"
#include "stream/store/log.h"
#include "stream/store/note.h"

namespace pss {

inline constexpr std::uint32_t kTilePoints = 1u << 18;  ///< a tile owns at most so many points
/// A row has at most so many bytes; a file that claims more is refused.
inline constexpr std::size_t kMaxRowSize = 1 << 16;

/// What is known before the first tile: the manifest's first record.
struct StoreHeader {
  Lattice lattice;
  Schema schema;
  std::uint32_t tile_points = kTilePoints;
  bool ordered =
      true;  ///< rows in key order; false for results, whose rows keep their source's order
  std::optional<Lattice> grid;  ///< that a file written from this gets, if its format has one
  InputsDigest inputs;          ///< the store's InputTable has what is known of each
  std::string parameters;       ///< JSON: what made the rows, beyond the inputs

  bool operator==(const StoreHeader&) const = default;
};
/// A job has so many headers at once: the store that is read, the operator's for the result, and
/// the bytes that are written to the result's log, or read from a log.
inline constexpr std::uint64_t kHeaderCopies = 3;
/// Of the head of an input there are at most so many at once: as a reader or the table of inputs
/// gives it, its bytes on their way from or to that table, or made by a writer whose points need
/// another head; and its coordinate system counts beside it.
inline constexpr std::uint64_t kHeadCopies = 3;

/// What a header's text holds, with the copies that a job has of it.
std::uint64_t memory_of(const StoreHeader& header);

/// What a tile's manifest record says.
///
/// A tile may be empty: whoever made it found no row to keep of its source tile. It has no blocks,
/// no bytes and an empty box, and stands where the tile before it ends.
struct TileInfo {
  std::uint64_t source = 0;  ///< number of the source's tile that it was made of; see next_source()
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
  Note note;  ///< of whoever wrote the tile: an operator's statistics
};

enum class RecordType : std::uint32_t { kHeader = 1, kTile = 2, kEnd = 3 };

/// The version of the format that this program writes and reads.
inline constexpr std::uint32_t kStoreVersion = 2;

/// What this program calls itself in the stores that it makes: "pss" and its version.
std::string producer();

std::vector<std::byte> encode_header(const StoreHeader& header,
                                     std::string_view made_by = producer());
/// Whether these bytes are those of encode_header(header, made_by). Allocates nothing.
bool is_encoded(const StoreHeader& header, std::span<const std::byte> payload,
                std::string_view made_by = producer());
/// Errors: kBadInput where a header's record is of another version of the format.
Result<void> check_version(const std::string& path, std::span<const std::byte> payload);
/// Who made a store, by its header's record. Requires: check_version().
std::string producer_in(std::span<const std::byte> payload);
/// The header of a record at `offset` of the manifest `path`. Errors: kBadInput.
Result<StoreHeader> decode_header(const std::string& path, std::uint64_t offset,
                                  std::span<const std::byte> payload);
std::vector<std::byte> encode_tile(const TileInfo& tile);  ///< without first_row, which follows

/// Bytes of a block's entry in a tile's index.
std::size_t index_entry_size(const Schema& schema);

/// Everything a manifest holds, built record by record.
struct Manifest {
  StoreHeader header;
  std::string producer;  ///< of whoever made the store
  std::vector<TileInfo> tiles;
  bool complete = false;
  std::uint64_t input_bytes = 0;  ///< of the file of the table of inputs
  Note note;                      ///< of the whole store, once it is complete
  std::string summary;
  bool has_header = false;

  std::uint64_t points() const;
  /// The number of the first tile of the source that comes after all that tiles were made of: where
  /// whoever makes them goes on. A store that was not made of another numbers its own tiles.
  std::uint64_t next_source() const;
  /// How many segments hold tiles; empty tiles lie in none.
  std::uint32_t segments() const;
  /// Checks a record against what came before it and takes it in.
  ///
  /// Errors: kBadInput with `path` and the record's offset.
  Result<void> add(const std::string& path, const LogRecord& record);
};

/// The record that ends a manifest.
std::vector<std::byte> encode_end(const Manifest& manifest);

// The names inside a store's directory. A finished manifest gets its final name, and only that may
// not have a torn tail.
std::string manifest_path(const std::string& store);
std::string open_manifest_path(const std::string& store);
std::string segment_path(const std::string& store, std::uint32_t number);

/// Whether a directory is a store, finished or not, by the name of its manifest.
bool is_store(const std::string& path);
/// The same by the manifest's content: its first record is the header of a store.
bool has_manifest(const std::string& path);

}  // namespace pss
