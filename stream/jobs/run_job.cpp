#include "stream/jobs/run_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/parallel.h"
#include "io/file/file.h"
#include "io/file/fingerprint.h"
#include "io/formats/table.h"
#include "stream/jobs/attributes.h"
#include "stream/jobs/job.h"
#include "stream/jobs/job_memory.h"
#include "stream/jobs/job_space.h"
#include "stream/passes/scheduler.h"

namespace pss {
namespace {

using nlohmann::json;

/// Of the parameters, those that the sorted input depends on.
json sorting_parameters(const JobRequest& request, const SortingChoice& choice) {
  json j{{"tile-points", request.tile_points}, {"drop-outside", json()}};
  if (request.drop_outside)
    j["drop-outside"] = json{request.drop_outside->min, request.drop_outside->max};
  if (choice.has_lattice_step) j["scale"] = json();
  if (choice.lattice_step) j["scale"] = *choice.lattice_step;
  return j;
}

/// The record that the job's work directory gets. Errors: kFailed for inputs that cannot be read.
Result<JobRecord> job_record(const JobRequest& request, const JobKind& kind) {
  const PassNames passes = kind.passes();
  JobRecord record;
  record.command = kind.command();
  record.output = request.output;
  record.sorting = sorting_parameters(request, kind.sorting()).dump();
  record.parameters = kind.parameters().dump();
  record.passes = passes.names;
  record.may_grow = passes.may_grow;
  for (const std::string& input : request.inputs) {
    const std::string file = is_store_input(request) ? manifest_path(input) : input;
    PSS_ASSIGN(InputRecord found, settled_fingerprint(file));
    record.inputs.push_back(std::move(found));
  }
  return record;
}

/// Of the tiles of a source, those that a result has already.
std::size_t tiles_done(const Source& source, const StoreWriter& result) {
  return std::min<std::size_t>(source.tiles().size(), result.next_source());
}

/// One run of a job, in the order of the members.
class JobRun {
 public:
  JobRun(const JobRequest& request, JobKind& kind, MemoryBudget& budget, Monitor& monitor)
      : request_(request), kind_(kind), budget_(budget), monitor_(monitor) {}

  Result<JobReport> run() {
    const Stopwatch total;
    PSS_TRY(kind_.check());
    PSS_TRY(check_request(request_));
    PSS_TRY(check_places(request_));
    // Order: fingerprints first, so that whatever is read of an input is known to be of that file.
    PSS_ASSIGN(JobRecord record, job_record(request_, kind_));
    PSS_ASSIGN(const Reservation inputs, reserve_inputs(request_, kind_, budget_));
    PSS_ASSIGN(Job started, Job::enter(request_, std::move(record), monitor_));
    report_.already_complete = started.complete();
    report_.resumed = started.resumed();
    if (!started.complete())
      if (auto done = do_work(started); !done) return started.fail(std::move(done).error());
    report_.total_seconds = total.seconds();
    describe_run();
    return std::move(report_);
  }

 private:
  Result<void> do_work(Job& started);
  Result<bool> has_result(const Job& started) const;
  Result<void> check_owner(const Store& store) const;
  Result<void> compute(Job& started);
  Result<void> sort_input(const Job& started);
  Result<std::uint64_t> bytes_present(const Job& started, const PassContext& context) const;
  Result<void> check_first(const Pass& pass);
  Result<void> check_pass_space(const Pass& pass, std::uint64_t present) const;
  Result<DonePass> run_pass(const Pass& pass, const std::string& path);
  Result<void> finish(const Pass& pass, StoreWriter& result, const Note& note) const;
  Result<void> write(Job& started);
  Result<void> hand_over(Job& started, const std::string& path, std::optional<Store> result);
  void describe_run();

  const JobRequest& request_;
  JobKind& kind_;
  MemoryBudget& budget_;
  Monitor& monitor_;
  std::string identity_;  ///< of the job
  JobReport report_;
};

Result<void> JobRun::do_work(Job& started) {
  identity_ = identity_of(started.record());
  PSS_ASSIGN(const bool computed, has_result(started));
  if (!computed) PSS_TRY(compute(started));
  PSS_TRY(started.drop_sources());  // the output needs the room
  PSS_TRY(write(started));
  return started.leave();
}

/// Whether the work directory has the finished result of this very job.
///
/// Errors: where what is there is damaged, or of another job: told before anything is computed.
Result<bool> JobRun::has_result(const Job& started) const {
  const JobRecord& record = started.record();
  const std::string path = started.work().result_store(record);
  if (record.passes.empty() || !is_store(path)) return false;
  PSS_ASSIGN(const Store store, Store::open(path));
  PSS_TRY(check_owner(store));
  return !record.may_grow && store.complete() && exists(manifest_path(path));
}

Result<void> JobRun::check_owner(const Store& store) const {
  if (owner_in(store.header().parameters) == identity_) return {};
  return Error{Fault::kFailed,
               fmt::format("{}: is the result of another job, or of other inputs; use --restart "
                           "to compute it again",
                           store.path())};
}

/// Sorts, and runs pass after pass.
Result<void> JobRun::compute(Job& started) {
  if (!is_store_input(request_)) PSS_TRY(sort_input(started));
  PassContext context{
      .request = request_,
      .kind = kind_,
      .work_dir = started.work().path(),
      .inputs = started.record().inputs,
      .identity = identity_,
      .budget = budget_,
      .monitor = monitor_,
      .report = report_,
  };
  for (;;) {
    // Order: what is there is looked at before an operator has a header.
    PSS_ASSIGN(const std::uint64_t present, bytes_present(started, context));
    PSS_ASSIGN(const std::optional<Pass> pass, kind_.next(context));
    if (!pass) return started.end_passes();
    if (context.done.empty()) PSS_TRY(check_first(*pass));
    PSS_TRY(check_pass_space(*pass, present));
    PSS_TRY(started.begin_pass(pass->name));
    PSS_ASSIGN(DonePass done, run_pass(*pass, started.work().pass_store(pass->name)));
    context.done.push_back(std::move(done));
  }
}

/// Its plan is gone when the store of the sorted points is opened.
Result<void> JobRun::sort_input(const Job& started) {
  const WorkDirectory& work = started.work();
  PSS_ASSIGN(const IngestOptions options, ingest_options(request_, kind_));
  std::optional<StageTimer> timer(std::in_place, "plan", report_.stages);
  PSS_ASSIGN(const IngestPlan plan, plan_ingest(started.record().inputs, options, monitor_));
  PSS_TRY(check_attributes(request_, kind_, plan.header));
  PSS_TRY(check_least(request_, kind_, plan.header, plan.points, plan.unit, budget_));
  report_.notes.insert(report_.notes.end(), plan.notes.begin(), plan.notes.end());
  timer.emplace("sort", report_.stages);
  PSS_ASSIGN(report_.ingest,
             ingest(plan, work.input_store(), work.path(), options, budget_, monitor_));
  return {};
}

/// What the stores of the passes to come take already.
Result<std::uint64_t> JobRun::bytes_present(const Job& started, const PassContext& context) const {
  std::uint64_t present = 0;
  for (const std::string& pass : started.record().passes) {
    const std::string path = started.work().pass_store(pass);
    const bool done = std::ranges::find(context.done, pass, &DonePass::name) != context.done.end();
    if (done || !is_store(path)) continue;
    PSS_ASSIGN(const Store store, Store::open(path));
    present += store.bytes_on_disk();
  }
  return present;
}

/// Refuses an output that cannot hold what the passes will make of the sorted input.
Result<void> JobRun::check_first(const Pass& pass) {
  PSS_ASSIGN(const std::string note,
             check_output_grid(pass.source().store(), request_, pass.largest_move, monitor_));
  if (!note.empty()) report_.notes.push_back(note);
  return {};
}

Result<void> JobRun::check_pass_space(const Pass& pass, std::uint64_t present) const {
  std::vector<StoreShape> shapes{shape_of(*pass.op)};
  shapes.insert(shapes.end(), pass.later.begin(), pass.later.end());
  return check_space(request_, job_space(request_, stored_points(pass.source().store()), shapes),
                     present);
}

/// Runs a pass into its store, or goes on with what is there.
Result<DonePass> JobRun::run_pass(const Pass& pass, const std::string& path) {
  StageTimer timer(pass.name, report_.stages);
  const Source& source = pass.source();
  const StoreHeader& header = pass.op->result_header();
  PSS_ASSIGN(StoreWriter result, is_store(path) ? StoreWriter::resume(path, header)
                                                : StoreWriter::create(path, header));
  if (!result.complete()) {  // it may be so, too, where it was stopped while it was finished
    monitor_.begin(pass.name, source.points(), source.tiles().size());
    for (const TileInfo& tile : source.tiles().first(tiles_done(source, result)))
      monitor_.advance(tile.count, 1);
    PSS_ASSIGN(const ScheduleSummary schedule,
               run_operator(pass.sources(), *pass.op, result, budget_, monitor_));
    timer.set_schedule(schedule);
  }
  PSS_ASSIGN(Note note, merged_notes(*pass.op, result.tiles(), path));
  if (!result.complete()) PSS_TRY(finish(pass, result, note));
  return DonePass{pass.name, result.points(), std::move(note)};
}

/// Ends the store of a pass, with the inputs of its source where it knows of any.
Result<void> JobRun::finish(const Pass& pass, StoreWriter& result, const Note& note) const {
  if (pass.op->result_header().inputs.count > 0)
    PSS_TRY(copy_inputs(pass.source().path(), result.path()));
  return result.finish(result_summary(report_, kind_), note);
}

/// Reads what the report says of the result, and hands that over.
Result<void> JobRun::write(Job& started) {
  const StageTimer timer("write", report_.stages);
  const std::string path = started.work().result_store(started.record());
  PSS_ASSIGN(Store result, Store::open(path));
  report_.points_out = result.points();
  report_.tiles = result.tiles().size();
  report_.result_bytes = report_.store_bytes = result.bytes_on_disk();
  if (!started.record().passes.empty()) read_result_summary(result.summary(), report_, kind_);
  PSS_TRY(kind_.look_at(result, report_));
  return hand_over(started, path, std::move(result));
}

/// The one place where a result becomes what the user asked for.
Result<void> JobRun::hand_over(Job& started, const std::string& path, std::optional<Store> result) {
  PSS_ASSIGN(const Format* file, sink_of(request_));
  if (!file) {
    result.reset();
    return started.hand_over_store(path);
  }
  ExportOptions options = export_options(request_);
  options.rules = started.output_rules();
  PSS_ASSIGN(const ExportSummary written,
             export_store(*result, request_.output, options, budget_, monitor_));
  report_.notes.insert(report_.notes.end(), written.notes.begin(), written.notes.end());
  if (written.grid) report_.rounding_step = *std::ranges::max_element(written.grid->scale);
  return {};
}

void JobRun::describe_run() {
  report_.command = kind_.command();
  report_.inputs = request_.inputs;
  report_.output = request_.output;
  report_.work_dir = request_.work_directory();
  report_.points_in = report_.ingest.points_read;
  report_.peak_memory = peak_resident();
  report_.memory_limit = budget_.limit();
  report_.threads = thread_count();
}

}  // namespace

Result<JobReport> run_job(const JobRequest& request, JobKind& kind, MemoryBudget& budget,
                          Monitor& monitor) {
  return JobRun(request, kind, budget, monitor).run();
}

Result<IngestOptions> ingest_options(const JobRequest& request, const JobKind& kind) {
  PSS_ASSIGN(const Format* file, sink_of(request));
  IngestOptions options;
  options.tile_points = request.tile_points;
  options.drop_outside = request.drop_outside;
  options.scale = kind.sorting().lattice_step;
  if (file && file->integer_grid) options.gridded_output = export_options(request);
  return options;
}

}  // namespace pss
