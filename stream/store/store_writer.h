#pragma once
// Appends tiles to a store, durably, so that a killed writer goes on at the last committed tile.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/morton.h"
#include "core/result.h"
#include "io/file/file.h"
#include "stream/store/block.h"
#include "stream/store/first_failure.h"
#include "stream/store/log.h"
#include "stream/store/manifest.h"

namespace pss {

/// A segment that has reached this size takes no further tile.
inline constexpr std::uint64_t kSegmentSize = std::uint64_t{1} << 30;

/// Refuses what is not a store, by its manifest, or holds anything beside one; a missing directory
/// and an empty one are none of these.
Result<void> check_removable(const std::string& path);
/// Removes a store; a missing one is no error.
///
/// Errors: kFailed, with nothing removed, for what check_removable() refuses.
Result<void> remove_store(const std::string& path);

/// Removes what is left of a store where its directory is known to be pss's own by other means; a
/// missing one is no error. Errors: kFailed, with nothing removed, where it holds anything else.
Result<void> remove_store_files(const std::string& path);

/// Appends tiles to a store, durably, one at a time.
///
/// A failure is final: whatever is called after it gives the same error and does nothing.
/// Thread: one.
class StoreWriter {
 public:
  /// Starts a new store; a store that was at `path` is removed.
  ///
  /// Errors: kFailed where `path` holds anything that is not part of a store.
  static Result<StoreWriter> create(const std::string& path, const StoreHeader& header,
                                    std::uint64_t segment_size = kSegmentSize);
  /// Goes on with a store whose header equals `header`: cuts the torn tail of the manifest and
  /// unrecorded segment bytes. Errors: kFailed where the headers differ, or where another version
  /// of pss began a store that is not complete; kBadInput where damaged.
  static Result<StoreWriter> resume(const std::string& path, const StoreHeader& header,
                                    std::uint64_t segment_size = kSegmentSize);

  const std::string& path() const { return path_; }
  std::span<const TileInfo> tiles() const { return manifest_.tiles; }
  std::uint64_t points() const { return manifest_.points(); }
  /// Where to go on: the number of the source's first tile that no tile was made of.
  std::uint64_t next_source() const { return manifest_.next_source(); }
  bool complete() const { return manifest_.complete; }
  const std::string& summary() const { return manifest_.summary; }

  /// Appends a block of the tile that is being written.
  Result<void> append(const EncodedBlock& block);
  /// Ends the tile: index, fsync of the segment, manifest record, fsync of the manifest. Without
  /// blocks the tile is empty, and says that nothing is left of its source tile.
  ///
  /// Tiles may share the syncs: with `sync` false they become durable at the next commit with true.
  /// Requires: `source`, the number of the tile that this one was made of, is not below
  ///           next_source(), which is what a store that is made of no other passes.
  Result<void> commit_tile(const Cell& cell, std::uint64_t source, Note note = {},
                           bool sync = true);
  /// Makes all committed tiles durable.
  Result<void> sync();
  /// Bytes of tiles that are committed and not durable yet.
  std::uint64_t unsynced_bytes() const { return unsynced_bytes_; }
  /// Ends the store. Requires: where the header has inputs, their table is written: by an
  /// InputTableWriter, or copy_inputs(). `summary` is JSON that readers find in Store::summary(),
  /// `note` what they find in Store::note().
  Result<void> finish(const std::string& summary, const Note& note = {});

 private:
  StoreWriter() = default;
  Result<void> add_record(const std::string& name, const LogRecord& record,
                          const StoreHeader& header);
  Result<void> take_header(const std::string& name, std::span<const std::byte> payload,
                           const StoreHeader& header);
  Result<void> open_manifest(const std::string& name, const StoreHeader& header);
  Result<void> cut_segments();
  Result<void> next_segment();
  Result<void> write_block(const EncodedBlock& block);
  Result<std::vector<std::byte>> write_index();
  Result<void> end_tile(const Cell& cell, std::uint64_t source, Note note);
  Result<void> write_records();
  Result<void> end_store(const std::string& summary, const Note& note);
  Result<void> rename_manifest();
  std::string path_;
  std::uint64_t segment_limit_ = kSegmentSize;
  FirstFailure failure_;
  Manifest manifest_;
  std::optional<LogWriter> log_;
  std::size_t recorded_ = 0;  ///< tiles whose record is in the log
  std::optional<File> segment_;
  std::uint32_t segment_number_ = 0;
  std::uint64_t segment_size_ = 0;
  std::uint64_t unsynced_bytes_ = 0;
  std::vector<BlockInfo> blocks_;  ///< of the tile that is being written
};

}  // namespace pss
