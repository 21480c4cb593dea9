// How far a job is: `info WORKDIR`.

#include <fmt/format.h>

#include "stream/smooth.h"
#include "stream/smooth_job.h"

namespace pss {
namespace {

std::uint64_t tiles_in(const std::string& path) {
  if (!is_store(path)) return 0;
  const Result<Store> store = Store::open(path);
  return store ? store->tiles().size() : 0;
}

/// The stage that the stores in the directory show.
void find_stage(const std::string& input, const std::string& normals, const std::string& result,
                JobState& state) {
  const bool first_pass = is_store(normals) && !is_complete_store(normals);
  if (!is_complete_store(input) && !is_store(normals) && !is_store(result)) {
    state.stage = "sort";
    state.tiles_done = tiles_in(input);
    return;
  }
  state.stage = is_complete_store(result) ? "write" : first_pass ? "normals" : "smooth";
  state.tiles_done = tiles_in(first_pass ? normals : result);
  // Once the result is complete the sorted input goes.
  if (const Result<Store> source = Store::open(is_complete_store(result) ? result : input)) {
    state.tiles = source->tiles().size();
    state.points = source->points();
  }
}

}  // namespace

Result<JobState> read_job_state(const std::string& work_dir) {
  PSS_ASSIGN(const std::optional<JobRecord> record, read_job_record(work_dir));
  if (!record)
    return Error{Fault::kBadInput,
                 fmt::format("{}: found no job.json, expected a work directory", work_dir)};
  JobState state;
  state.command = record->command;
  state.output = record->output;
  state.parameters = record->parameters;
  for (const InputRecord& input : record->inputs) state.inputs.push_back(input.path);
  state.holder = job_holder(work_dir);
  if (record->complete) {
    state.stage = "complete";
    return state;
  }
  // The sorted input of a job over a store is that store itself.
  const bool over_store =
      record->inputs.size() == 1 && is_store(directory_of(record->inputs.front().path));
  find_stage(over_store ? directory_of(record->inputs.front().path) : work_dir + "/input.pss",
             work_dir + "/normals.pss", work_dir + "/result.pss", state);
  return state;
}

}  // namespace pss
