#pragma once
// What every job is asked, whatever it computes: where it reads, works and writes, how it sorts.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/monitor.h"
#include "core/result.h"
#include "io/formats/table.h"
#include "io/points/points.h"
#include "stream/sort/ingest.h"
#include "stream/store/export.h"
#include "stream/store/store.h"

namespace pss {

/// What the jobs of all kinds share; a kind's own request adds to it.
struct JobRequest {
  std::vector<std::string> inputs;  ///< files, or one store
  std::string output;               ///< a file, or NAME.pss to keep the store
  std::string work_dir;             ///< empty: OUTPUT.work, which is gone after success
  /// Where it is remembered that OUTPUT is complete once OUTPUT.work is gone; empty: nowhere.
  std::string state_folder;
  bool overwrite = false;
  bool restart = false;
  bool keep_work = false;
  // What the result depends on.
  std::uint32_t tile_points = kTilePoints;
  std::optional<WorldBox> drop_outside;  ///< points outside this box are left out, and counted
  std::optional<World3> scale;           ///< of an output with an integer grid
  bool scale_auto = false;               ///< the finest scale that holds the result
  std::optional<World3> offset;          ///< of an output with an integer grid

  std::string work_directory() const { return work_dir.empty() ? output + ".work" : work_dir; }
};

/// Errors: kUsage for what is contradictory or makes no sense, whatever the job computes.
Result<void> check_request(const JobRequest& request);

/// Refuses places that would endanger each other, before anything is made: an output or an input
/// within the work directory, or the other way round, a work directory that is not pss's own, an
/// input within a store that is to be replaced, a store's output on another disk than the work
/// directory, from where it could not be renamed.
///
/// Errors: kUsage; those of check_work_directory().
Result<void> check_places(const JobRequest& request);

/// Whether the points are sorted already, in a store that is the only input.
bool is_store_input(const JobRequest& request);

/// Where the result goes: into a file of this format; null: it stays a store.
///
/// Errors: kUsage for an output of no known format.
Result<const Format*> sink_of(const JobRequest& request);

/// How the result is written as a file.
ExportOptions export_options(const JobRequest& request);

/// Refuses, before anything is measured, a grid that cannot hold the sorted points as they are.
Result<void> check_output_box(const Store& source, const JobRequest& request);
/// Refuses what the output could not hold once points have moved by at most `largest_move`; returns
/// what should be known of it. Errors: those of check_export().
Result<std::string> check_output_grid(const Store& source, const JobRequest& request,
                                      double largest_move, Monitor& monitor);

}  // namespace pss
