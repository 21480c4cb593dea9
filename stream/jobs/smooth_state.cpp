// How far a job is: `info WORKDIR`.

#include <fmt/format.h>

#include "stream/jobs/job_record.h"
#include "stream/jobs/smooth.h"
#include "stream/jobs/smooth_job.h"

namespace pss {
namespace {

/// The store at a path, where one is there.
Result<std::optional<Store>> store_at(const std::string& path) {
  if (!is_store(path)) return std::optional<Store>();
  Result<Store> store = Store::open(path);
  if (store) return std::optional(*std::move(store));
  // A running job removes what it needs no more.
  if (!is_store(path)) return std::optional<Store>();
  return store.error();
}

/// The stage that the stores in the directory show.
Result<void> find_stage(const std::string& input, const std::string& normals,
                        const std::string& result, JobState& state) {
  const bool first_pass = is_store(normals) && !is_complete_store(normals);
  const bool sorting = !is_complete_store(input) && !is_store(normals) && !is_store(result);
  state.stage = sorting                     ? "sort"
                : is_complete_store(result) ? "write"
                : first_pass                ? "normals"
                                            : "smooth";
  std::optional<Store> growing;
  PSS_ASSIGN(growing, store_at(sorting ? input : first_pass ? normals : result));
  if (growing) state.tiles_done = growing->tiles().size();
  if (sorting) return {};
  // Once the result is complete the sorted input goes.
  std::optional<Store> source;
  PSS_ASSIGN(source, store_at(is_complete_store(result) ? result : input));
  if (!source) return {};
  state.tiles = source->tiles().size();
  state.points = source->points();
  return {};
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
  state.parameters = all_parameters(*record);
  state.spoiled = record->spoiled;
  for (const InputRecord& input : record->inputs) state.inputs.push_back(input.path);
  state.holder = job_holder(work_dir);
  if (record->complete) {
    state.stage = "complete";
    return state;
  }
  // The sorted input of a job over a store is that store itself.
  const std::string first = record->inputs.empty() ? "" : record->inputs.front().path;
  const bool over_store =
      first == manifest_path(directory_of(first)) && has_manifest(directory_of(first));
  PSS_TRY(find_stage(over_store ? directory_of(first) : work_dir + "/input.pss",
                     work_dir + "/normals.pss", work_dir + "/result.pss", state));
  return state;
}

}  // namespace pss
