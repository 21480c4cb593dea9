#pragma once
// All inputs one after the other, their points on the common lattice, their rows in one schema.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/points/reader.h"
#include "stream/sort/chunk.h"
#include "stream/sort/ingest.h"
#include "stream/sort/placement.h"
#include "stream/sort/run_log.h"

namespace pss {

/// Names of the source column: the number of the input, and the record's number in it.
inline constexpr const char* kSourceFile = "SourceFile";
inline constexpr const char* kSourceRecord = "SourceRecord";

/// So many batches are on their way at once, each of at most so many points.
struct Batches {
  std::size_t points = 0;
  std::size_t count = 0;
};

/// Reads points in the inputs' order; counts what it drops and moves.
///
/// Records are fetched by one thread at a time, so that the disk is read front to back, and decoded
/// and placed by all, each batch of them apart.
class InputStream {
 public:
  /// Begins at `from`, going on with the counts of all before it.
  InputStream(const IngestPlan& plan, bool source_column, const Cursor& from,
              const IngestSummary& summary, std::vector<InputCounts> counts = {});

  /// Adds the points of the next `most` records to `chunk`, or of fewer: up to an input's end, and
  /// so that the last ones are not cut off from others that are decoded with them.
  ///
  /// Requires: room for so many, and batches of at least one point. Where `most`, or a batch, is
  ///           less than the input's Reader::unit(), records are decoded more than once.
  /// Errors:   those of readers; kBadInput with file and record where a position lies outside the
  ///           lattice; kFailed where the input changed since the plan was made, which is certain
  ///           to be noticed only at its end; kInterrupted.
  Result<void> read(std::size_t most, const Batches& batches, Chunk& chunk, const Monitor& monitor);

  /// Refuses the input at the cursor where it changed since the plan was made. What was read of the
  /// inputs before it, up to their ends, is known to be of the planned files.
  ///
  /// Errors: kFailed.
  Result<void> check_input() const;

  /// Goes on from there; the counts stay what they are.
  Result<void> seek(const Cursor& to);

  bool ended() const { return cursor_.input == plan_.inputs.size(); }
  const Cursor& cursor() const { return cursor_; }
  const IngestSummary& summary() const { return summary_; }
  /// The same of each input by itself.
  const std::vector<InputCounts>& counts() const { return counts_; }

 private:
  /// Points of an input between the file and the chunk.
  struct Batch {
    RawPoints raw;
    std::size_t at = 0;    ///< the first one's place in the chunk
    std::size_t kept = 0;  ///< the others are not finite, or outside the box that is kept
    std::uint64_t outside = 0;
    std::uint64_t moved = 0;
    double largest_move = 0;
    Result<void> result;
  };
  Result<void> open_input();
  const InputRecord& record() const { return plan_.inputs[cursor_.input]; }
  void prepare(Batch& batch, const Chunk& chunk) const;
  void write_sources(const PointBatch& points, std::span<std::byte> rows) const;
  Result<void> place(Batch& batch, std::span<Key> keys, std::span<std::byte> rows) const;
  bool dropped_outside(const PointBatch& points, std::size_t i) const;
  void count(const Batch& batch);
  Error outside(const PointBatch& points, std::size_t i) const;

  const IngestPlan& plan_;
  Cursor cursor_;
  IngestSummary summary_;
  std::vector<InputCounts> counts_;
  std::optional<std::size_t> source_file_, source_record_;  ///< where in the row
  std::unique_ptr<Reader> reader_;
  std::optional<RowMapper> mapper_;
  std::optional<Placement> placement_;
  std::vector<Batch> batches_;
};

/// What an InputStream holds of points with these rows.
std::uint64_t input_memory(const Schema& schema, const Batches& batches);

}  // namespace pss
