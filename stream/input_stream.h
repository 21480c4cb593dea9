#pragma once
// All inputs one after the other, their points on the common lattice, their rows in one schema.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/monitor.h"
#include "core/result.h"
#include "io/reader.h"
#include "stream/ingest.h"
#include "stream/keyed_rows.h"
#include "stream/placement.h"
#include "stream/run_log.h"

namespace pss {

/// Names of the source column: the number of the input, and the record's number in it.
inline constexpr const char* kSourceFile = "SourceFile";
inline constexpr const char* kSourceRecord = "SourceRecord";

/// Reads points in the inputs' order; counts what it drops and moves.
class InputStream {
 public:
  /// Begins at `from`, going on with the counts of all before it.
  InputStream(const IngestPlan& plan, bool source_column, const Cursor& from,
              const IngestSummary& summary);

  /// Replaces `out` by about `max` following points, or fewer; see ended().
  ///
  /// Errors: kBadInput with file and record where a position lies outside the lattice.
  Result<void> read(std::size_t max, KeyedRows& out);

  /// Goes on from there; the counts stay what they are.
  Result<void> seek(const Cursor& to);

  bool ended() const { return cursor_.input == plan_.inputs.size(); }
  const Cursor& cursor() const { return cursor_; }
  const IngestSummary& summary() const { return summary_; }

 private:
  Result<void> open_input();
  Result<void> place(KeyedRows& out);
  void map_rows(KeyedRows& out);
  void write_sources(KeyedRows& out) const;
  void drop_not_finite(KeyedRows& out);
  Error outside(std::size_t i) const;

  const IngestPlan& plan_;
  Cursor cursor_;
  IngestSummary summary_;
  std::optional<std::size_t> source_file_, source_record_;  ///< where in the row
  std::unique_ptr<Reader> reader_;
  std::optional<RowMapper> mapper_;
  std::optional<Placement> placement_;
  PointBatch batch_;
  std::vector<Placed> placed_;
  std::vector<double> moves_;
};

/// What an InputStream holds for each point of a batch.
std::uint64_t input_bytes_per_point(const Schema& schema);

}  // namespace pss
