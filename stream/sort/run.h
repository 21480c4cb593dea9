#pragma once
// A run: a file of points in order, as compressed blocks, that is written once and merged once.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/morton.h"
#include "core/result.h"
#include "io/file/file.h"
#include "io/points/schema.h"
#include "stream/sort/early_sync.h"
#include "stream/store/block.h"
#include "stream/store/keyed_rows.h"

namespace pss {

inline constexpr std::size_t kRunBlockPoints = 2048;

/// What the run log says of a run.
struct RunInfo {
  std::uint64_t id = 0;
  std::uint64_t points = 0;
  std::uint64_t blocks = 0;
  std::uint64_t data_size = 0;  ///< the index of first keys follows at this offset

  bool operator==(const RunInfo&) const = default;
};

std::string run_path(const std::string& folder, std::uint64_t id);
/// Whether run_path() gives files such names: "run-000012".
bool is_run_name(std::string_view name);

/// Writes a run: points come in order, any number at a time.
class RunWriter {
 public:
  static Result<RunWriter> create(const std::string& folder, std::uint64_t id,
                                  std::uint64_t early_sync = SyncSizes().early);

  /// `first` is the key of the block's first point.
  Result<void> append(const Key& first, const EncodedBlock& block);
  /// Writes the index, the last of the file.
  Result<RunInfo> finish();
  /// Makes the file and its name durable. Thread: any, once finished.
  Result<void> sync();

 private:
  RunWriter(File file, std::string folder, std::uint64_t id, std::uint64_t early_sync);
  Result<void> write(std::span<const std::byte> bytes);
  File file_;
  std::string folder_;
  RunInfo info_;
  std::uint64_t size_ = 0;
  std::vector<std::byte> index_;
  EarlySync early_sync_;
};

/// A block of a run as it lies in the file, checked and not decoded yet.
struct RunBlock {
  std::size_t count = 0;            ///< points; none at the end of the run
  std::vector<ColumnInfo> columns;  ///< offsets in the file
  std::vector<std::byte> bytes;     ///< of all columns
};

/// Reads a run block by block.
///
/// Errors: kBadInput with file and offset where the bytes are not those that were written.
class RunReader {
 public:
  static Result<RunReader> open(const std::string& folder, const RunInfo& info,
                                const Schema& schema);

  /// Goes to the first block that may hold a point with a key not below `key`.
  Result<void> seek(const Key& key);
  /// Replaces `out` by the next block; one without points at the end.
  Result<void> next(RunBlock& out);
  bool ended() const { return offset_ >= info_.data_size; }
  /// The points of a block. Shape: `keys` and `rows` hold block.count of them.
  ///
  /// Thread: any number at once.
  Result<void> decode(const RunBlock& block, std::span<Key> keys, std::span<std::byte> rows) const;

 private:
  RunReader(File file, const RunInfo& info, const Schema& schema);
  Error damaged(std::uint64_t offset) const;
  File file_;
  RunInfo info_;
  const Schema* schema_;
  std::uint64_t offset_ = 0;
};

}  // namespace pss
