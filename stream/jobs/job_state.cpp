#include "stream/jobs/job_state.h"

#include <fmt/format.h>

#include <algorithm>

#include "stream/jobs/job_record.h"
#include "stream/jobs/work_directory.h"
#include "stream/store/store.h"

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

bool is_complete_store(const std::string& path) {
  if (!is_store(path)) return false;
  const Result<Store> store = Store::open(path);
  return store && store->complete() && exists(manifest_path(path));
}

/// A stage, and the stores that tell how far it is.
struct Stage {
  std::string name;
  std::string growing;
  std::string source;  ///< of its tiles; empty: not known
};

/// The last pass that has a store is being computed, or the one after it.
Stage stage_of(const std::string& input, const std::string& work_dir, const JobRecord& record) {
  const auto store_of = [&](const std::string& pass) { return pass_store_in(work_dir, pass); };
  const auto& passes = record.passes;
  const auto last = std::ranges::find_if(passes.rbegin(), passes.rend(), is_store, store_of);
  if (last == passes.rend()) {
    if (!is_complete_store(input)) return {"sort", input, ""};
    if (passes.empty()) return {"write", input, input};
    return {passes.front(), store_of(passes.front()), input};
  }
  if (!is_complete_store(store_of(*last))) return {*last, store_of(*last), input};
  if (last != passes.rbegin()) return {*(last - 1), store_of(*(last - 1)), input};
  // Once the result is complete the sorted input goes.
  return {record.may_grow ? *last : "write", store_of(*last), store_of(*last)};
}

Result<void> count_tiles(const Stage& stage, JobState& state) {
  std::optional<Store> store;
  PSS_ASSIGN(store, store_at(stage.growing));
  if (store) state.tiles_done = store->tiles().size();
  PSS_ASSIGN(store, store_at(stage.source));
  if (!store) return {};
  state.tiles = store->tiles().size();
  state.points = store->points();
  return {};
}

/// The sorted input of a job over a store is that store itself.
std::string sorted_input_of(const std::string& work_dir, const JobRecord& record) {
  const std::string first = record.inputs.empty() ? "" : record.inputs.front().path;
  const std::string folder = directory_of(first);
  const bool over_store = first == manifest_path(folder) && has_manifest(folder);
  return over_store ? folder : input_store_in(work_dir);
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
  const Stage stage = stage_of(sorted_input_of(work_dir, *record), work_dir, *record);
  state.stage = stage.name;
  PSS_TRY(count_tiles(stage, state));
  return state;
}

}  // namespace pss
