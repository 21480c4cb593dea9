#pragma once
// What a job of any kind tells of itself when it is done: one report a stage, and what all share.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stream/limit/stopwatch.h"
#include "stream/limit/transfer.h"
#include "stream/passes/scheduler.h"
#include "stream/sort/ingest.h"

namespace pss {

/// What a stage of this run took.
struct StageReport {
  std::string name;  ///< "plan", "sort", what a kind measures ("spacing"), its passes, "write"
  double seconds = 0;
  Transfer transfer;
  std::optional<ScheduleSummary> schedule;  ///< of a pass that had tiles left to do
};

/// Measures a stage from here to the end of its life, and adds its report to `stages` then.
class StageTimer {
 public:
  StageTimer(std::string name, std::vector<StageReport>& stages)
      : stages_(&stages), before_(transferred()) {
    report_.name = std::move(name);
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer();

  void set_schedule(const ScheduleSummary& schedule) { report_.schedule = schedule; }

 private:
  std::vector<StageReport>* stages_;
  StageReport report_;
  Stopwatch watch_;
  Transfer before_;
};

/// All that a run of any kind has to tell.
struct JobReport {
  std::string command;
  bool already_complete = false;
  bool resumed = false;
  std::vector<std::string> inputs;
  std::string output;
  std::string work_dir;
  std::uint64_t points_in = 0;
  std::uint64_t points_out = 0;
  IngestSummary ingest;
  std::vector<StageReport> stages;  ///< of this run, in their order
  std::uint64_t tiles = 0;
  double rounding_step = 0;  ///< largest axis step of the written grid; 0 for floating point
  double total_seconds = 0;
  std::uint64_t store_bytes = 0;   ///< of the sorted input on disk
  std::uint64_t result_bytes = 0;  ///< of the result store
  std::uint64_t peak_memory = 0;
  std::uint64_t memory_limit = 0;
  int threads = 0;
  std::vector<std::string> notes;

  /// The report of a stage; an empty one where this run had none of that name.
  StageReport stage(std::string_view name) const;
};

// The parts of a report in JSON that are the same for all kinds; keys as docs/report.md has them.

/// Command, places, and whether the job had been done before.
nlohmann::ordered_json head_json(const JobReport& report);
/// The stages as a list, sizes, memory, threads and notes.
void add_tail_json(const JobReport& report, nlohmann::ordered_json& json);
nlohmann::ordered_json schedule_json(const ScheduleSummary& schedule);
nlohmann::ordered_json transfer_json(const Transfer& transfer, std::uint64_t points);
/// A report as text; bytes that are not UTF-8 become U+FFFD.
std::string report_text(const nlohmann::ordered_json& json);

}  // namespace pss
