#pragma once
// Input files to a store: read once, sort into runs, merge into tiles. Bounded, exact, resumable.

#include <cstdint>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/points/reader.h"
#include "io/watched_reader.h"
#include "stream/limit/memory.h"
#include "stream/sort/early_sync.h"
#include "stream/store/export.h"
#include "stream/store/store.h"

namespace pss {

struct IngestOptions {
  std::uint32_t tile_points = kTilePoints;
  std::optional<World3> scale;           ///< lattice step by hand
  std::optional<WorldBox> drop_outside;  ///< points outside this box are left out, and counted
  /// How a file of a format with an integer grid will be written of the store, where one will: it
  /// must hold the points.
  std::optional<ExportOptions> gridded_output;
  SyncSizes sync;
  bool source_column = false;  ///< adds SourceFile (uint32) and SourceRecord (uint64) to the rows
  OpenInput open = open_watched;  ///< what reads an input
};

/// What of the inputs decides the store: computed before any point is sorted.
struct IngestPlan {
  StoreHeader header;
  std::vector<InputRecord> inputs;
  std::vector<std::uint64_t> counts;      ///< points a file, as promised or measured
  std::vector<std::uint64_t> head_sizes;  ///< bytes of each one's head and coordinate system
  std::uint64_t points = 0;               ///< their sum
  std::size_t unit = 1;                   ///< the most records that an input decodes together
  OpenInput open = open_watched;
  std::optional<WorldBox> drop_outside;
  double spacing = 0;  ///< of the points, where all positions were read for the plan; 0: not known
  std::vector<std::string> notes;  ///< files whose points move onto the common lattice, ...
};

/// Reads the headers, and where a format has no bounds or grid, all positions once. The records of
/// the inputs are those of a job, taken by settled_fingerprint() before anything of them was read.
///
/// Errors: kBadInput for CRS mismatch, no common lattice, unsupported or damaged files, and for
///         floating-point positions of which some lie so far away that the lattice, or the grid
///         that a gridded output would get, is too coarse for the spacing of the others; kFailed
///         for files that changed since.
Result<IngestPlan> plan_ingest(std::vector<InputRecord> inputs, const IngestOptions& options,
                               Monitor& monitor);
/// The same of files as they are now.
Result<IngestPlan> plan_ingest(const std::vector<std::string>& inputs, const IngestOptions& options,
                               Monitor& monitor);

/// What became of the points read.
struct IngestSummary {
  std::uint64_t points_read = 0;
  std::uint64_t points_stored = 0;
  std::uint64_t dropped_not_finite = 0;
  std::uint64_t dropped_outside = 0;   ///< outside IngestOptions::drop_outside
  std::uint64_t moved_to_lattice = 0;  ///< points whose position was rounded
  double largest_move = 0;
  double spacing = 0;       ///< IngestPlan::spacing
  double read_seconds = 0;  ///< reading, sorting, writing runs
  double merge_seconds = 0;

  std::uint64_t dropped() const { return dropped_not_finite + dropped_outside; }
};

std::string to_json(const IngestSummary& summary);
Result<IngestSummary> ingest_summary_from_json(const std::string& text);

/// Makes the store `store_path` of the plan, keeping runs in `work_dir`/runs.
///
/// Interrupted at any moment and called again with an equal plan, it goes on from the last finished
/// run or merged tile and ends with the same bytes. A complete store returns at once.
///
/// Requires: reserve_inputs(). A head that is larger than the first input's takes more of `budget`,
///           while it is copied.
/// Errors: kFailed, beside those of reading and writing, where an input is no longer what the plan
///         says: the store stays incomplete, and of the runs each is of the planned files.
Result<IngestSummary> ingest(const IngestPlan& plan, const std::string& store_path,
                             const std::string& work_dir, const IngestOptions& options,
                             MemoryBudget& budget, Monitor& monitor);

}  // namespace pss
