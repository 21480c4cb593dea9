#pragma once
// How far an ingest is: the finished runs, what they cover of the inputs, what was dropped so far.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "stream/sort/ingest.h"
#include "stream/sort/run.h"
#include "stream/store/bytes.h"
#include "stream/store/input_table.h"
#include "stream/store/log.h"

namespace pss {

/// The next record to read: inputs before `input` are read whole.
struct Cursor {
  std::uint64_t input = 0;
  std::uint64_t record = 0;

  bool operator==(const Cursor&) const = default;
};

/// What a killed ingest goes on from.
struct IngestState {
  Cursor cursor;                    ///< all before it is in the runs
  IngestSummary summary;            ///< of all before the cursor
  std::vector<InputCounts> counts;  ///< the same of each input
  std::vector<RunInfo> runs;
  std::uint64_t next_id = 0;
};

/// Whether a folder of runs holds any: work that is worth going on with.
bool has_runs(const std::string& folder);
/// Removes a folder of runs; a missing one is no error.
///
/// Errors: kFailed, with nothing removed, where it holds anything else.
Result<void> remove_runs(const std::string& folder);

/// The log of a folder of runs.
class RunLog {
 public:
  /// Goes on with the log of `folder`, or starts one. A file that no record speaks of is
  /// replaced by the next run.
  ///
  /// Errors: kFailed where the log is of another plan; kBadInput where it is damaged.
  static Result<RunLog> open(const std::string& folder, const StoreHeader& header);

  const IngestState& state() const { return state_; }
  const std::string& folder() const { return folder_; }

  /// A run holds all points between the cursor and `cursor`; durable when this returns.
  ///
  /// Shape: `counts` has one element an input.
  Result<void> add(const RunInfo& run, const Cursor& cursor, const IngestSummary& summary,
                   std::span<const InputCounts> counts);
  /// A run takes the place of the first `count` runs, whose files are removed.
  Result<void> replace(std::size_t count, const RunInfo& run);

 private:
  RunLog() = default;
  Result<void> visit(const LogRecord& record, const StoreHeader& header);
  void read_cursor(ByteReader& reader);
  void replace_in_state(std::size_t count, const RunInfo& run);
  Result<void> remove_merged();
  std::string folder_;
  IngestState state_;
  std::vector<RunInfo> merged_;  ///< whose files are still to be removed
  std::optional<LogWriter> log_;
};

}  // namespace pss
