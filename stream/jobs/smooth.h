#pragma once
// The main job: files or a store in, every point projected onto its MLS surface, one file out.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/limit/transfer.h"
#include "stream/operators/project_statistics.h"
#include "stream/passes/normals.h"
#include "stream/passes/outputs.h"
#include "stream/passes/scheduler.h"
#include "stream/sort/ingest.h"
#include "stream/widths/widths.h"

namespace pss {

/// What the user asked for; what is empty is chosen and explained in the report.
struct SmoothOptions {
  // What the result depends on.
  MlsOperator op = MlsOperator::kLevin;
  WeightKind weight = WeightKind::kGaussian;
  std::optional<Precision> precision;
  WidthOptions widths;  ///< their degree is that of the polynomial, where the operator has one
  OutputSet outputs = 0;
  bool replace_attributes = false;  ///< outputs may take the place of attributes of the inputs
  std::optional<double> buffer;
  bool allow_inexact = false;
  std::optional<World3> scale;   ///< of an output with an integer grid
  bool scale_auto = false;       ///< the finest scale that holds the result
  std::optional<World3> offset;  ///< of an output with an integer grid
  std::uint32_t tile_points = kTilePoints;
  std::optional<WorldBox> drop_outside;  ///< points outside this box are left out, and counted
  // How the job runs.
  std::string work_dir;      ///< empty: OUTPUT.work
  std::string state_folder;  ///< where finished jobs are remembered; empty: nowhere
  bool overwrite = false;
  bool restart = false;
  bool keep_work = false;
};

struct SmoothJob {
  std::vector<std::string> inputs;  ///< files, or one store
  std::string output;               ///< a file, or NAME.pss to keep the store
  SmoothOptions options;
};

/// All that a run has to tell.
struct SmoothReport {
  bool already_complete = false;
  bool resumed = false;
  std::vector<std::string> inputs;
  std::string output;
  std::string work_dir;
  std::uint64_t points_in = 0;
  std::uint64_t points_out = 0;
  IngestSummary ingest;
  Method method;
  NormalsFrom normals = NormalsFrom::kNowhere;
  ChosenWidths widths;
  ProjectStatistics statistics;
  ScheduleSummary schedule;
  std::uint64_t tiles = 0;
  double rounding_step = 0;  ///< largest axis step of the written grid; 0 for floating point
  double plan_seconds = 0, ingest_seconds = 0, spacing_seconds = 0, normals_seconds = 0,
         smooth_seconds = 0, write_seconds = 0, total_seconds = 0;
  Transfer ingest_transfer, spacing_transfer, normals_transfer, smooth_transfer, write_transfer;
  std::uint64_t store_bytes = 0;   ///< of the sorted input on disk
  std::uint64_t result_bytes = 0;  ///< of the result store
  std::uint64_t peak_memory = 0;
  std::uint64_t memory_limit = 0;
  int threads = 0;
  std::vector<std::string> notes;
};

/// The report as JSON; keys are documented in docs/report.md and stable.
std::string to_json(const SmoothReport& report);

/// Runs the job, or goes on with it, or says that it is complete.
///
/// Errors: as in the table of exit codes; nothing is left under OUTPUT's name unless complete.
Result<SmoothReport> smooth(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor);

/// What a job would take. Exact to a block from a store; from files estimated by their headers.
struct SmoothEstimate {
  bool from_store = false;
  std::uint64_t points = 0;
  std::uint64_t tiles = 0;
  std::uint64_t parts = 0;
  double halo_share = 0;          ///< halo points over own points
  std::uint64_t peak_memory = 0;  ///< of the process
  std::uint64_t disk_bytes = 0;   ///< work directory and output together, at the worst moment
  double seconds = 0;             ///< of this machine and thread count
  Method method;
  NormalsFrom normals = NormalsFrom::kNowhere;
  ChosenWidths widths;  ///< only from a store
};
Result<SmoothEstimate> estimate_smooth(const SmoothJob& job, MemoryBudget& budget,
                                       Monitor& monitor);
std::string to_json(const SmoothEstimate& estimate);

/// How far a job is, for `info WORKDIR`.
struct JobState {
  std::string command;
  std::string output;
  std::string stage;  ///< "sort", "normals", "smooth", "write", "complete"
  std::uint64_t tiles_done = 0;
  std::uint64_t tiles = 0;  ///< 0 while unknown
  std::uint64_t points = 0;
  std::string parameters;  ///< JSON
  std::string spoiled;     ///< why it begins again; empty where it goes on
  std::vector<std::string> inputs;
  std::optional<std::string> holder;  ///< "process N on HOST" of a process that runs it now
};
/// Errors: kBadInput where the record or a store in the directory is damaged.
Result<JobState> read_job_state(const std::string& work_dir);

}  // namespace pss
