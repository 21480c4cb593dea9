#include "stream/jobs/smooth.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "io/file/fingerprint.h"
#include "io/points/writer.h"
#include "stream/jobs/output_clash.h"
#include "stream/jobs/smooth_job.h"
#include "stream/jobs/smooth_json.h"
#include "stream/jobs/smooth_memory.h"
#include "stream/jobs/smooth_method.h"
#include "stream/jobs/smooth_space.h"
#include "stream/limit/stopwatch.h"

namespace pss {
namespace {

Result<void> check_free(const std::string& folder, std::uint64_t present, std::uint64_t needed,
                        const char* what) {
  PSS_ASSIGN(const std::uint64_t free, free_space(folder));
  if (free + present >= needed) return {};
  return Error{Fault::kFailed, fmt::format("{}: {} MiB free, about {} MiB needed {}, or make room",
                                           folder, free >> 20, needed >> 20, what)};
}

/// What the stores that a job makes of its sorted input take already.
Result<std::uint64_t> bytes_present(const WorkDirectory& work) {
  std::uint64_t present = 0;
  for (const std::string& path : {work.normals_store(), work.result_store()}) {
    if (!is_store(path)) continue;
    PSS_ASSIGN(const Store store, Store::open(path));
    present += store.bytes_on_disk();
  }
  return present;
}

/// One run of a job, stage by stage, in the order of the members.
class SmoothRun {
 public:
  SmoothRun(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor)
      : job_(job), places_(places_of(job)), budget_(budget), monitor_(monitor) {}

  Result<SmoothReport> run() {
    const Stopwatch total;
    PSS_TRY(check_job(job_));
    PSS_TRY(check_places(places_));
    // Order: fingerprints first, so that whatever is read of an input is known to be of that file.
    PSS_ASSIGN(JobRecord record, job_record(job_));
    PSS_ASSIGN(const Reservation inputs, reserve_inputs(job_, budget_));
    PSS_ASSIGN(Job started, Job::enter(places_, std::move(record), monitor_));
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
  Result<void> compute(const Job& started);
  Result<Store> sorted_input(const Job& started);
  Result<void> sort_input(const Job& started);
  Result<Reservation> reserve_tables(const Store& store);
  Result<ChosenWidths> choose(const Store& source);
  Result<void> check(const Store& source, const WorkDirectory& work);
  Result<void> check_space(const Store& source, const ProjectOperator& op,
                           const WorkDirectory& work, std::uint64_t present) const;
  Result<void> compute_normals(const Store& source, const WorkDirectory& work);
  Result<void> project(const Store& source, const WorkDirectory& work);
  Result<StoreWriter> run_stage(const char* stage, const Store& source, const ProjectOperator& op,
                                const std::string& path);
  Result<void> write(Job& started);
  void note_if_few_moved();
  void describe_run();

  const SmoothJob& job_;
  JobPlaces places_;
  MemoryBudget& budget_;
  Monitor& monitor_;
  std::string identity_;  ///< of the job
  SmoothReport report_;
};

Result<void> SmoothRun::do_work(Job& started) {
  const WorkDirectory& work = started.work();
  identity_ = identity_of(started.record());
  PSS_ASSIGN(const bool computed, has_result(started));
  if (!computed) PSS_TRY(compute(started));
  if (!places_.keep_work) PSS_TRY(work.remove_sources());  // the output needs the room
  PSS_TRY(write(started));
  return started.leave();
}

/// Whether the work directory has the finished result of this very job.
///
/// Errors: where what is there is damaged, or of another job: told before anything is computed.
Result<bool> SmoothRun::has_result(const Job& started) const {
  const std::string path = started.work().result_store();
  if (!is_store(path)) return false;
  PSS_ASSIGN(const Store store, Store::open(path));
  if (identity_in(store.header().parameters) != identity_)
    return Error{Fault::kFailed,
                 fmt::format("{}: is the result of another job, or of other inputs; use --restart "
                             "to compute it again",
                             path)};
  return store.complete() && exists(manifest_path(path));
}

Result<void> SmoothRun::compute(const Job& started) {
  const WorkDirectory& work = started.work();
  PSS_ASSIGN(Store source, sorted_input(started));
  PSS_TRY(check_output_box(source, job_));
  PSS_ASSIGN(Reservation tables, reserve_tables(source));
  PSS_ASSIGN(const ChosenWidths widths, choose(source));
  report_.store_bytes = source.bytes_on_disk();
  report_.widths = widths;
  report_.normals = normals_from(source.header().schema, method_of(job_.options));
  PSS_TRY(check(source, work));
  if (report_.normals != NormalsFrom::kFirstPass) return project(source, work);
  PSS_TRY(compute_normals(source, work));
  PSS_ASSIGN(source, Store::open(work.normals_store()));
  tables.release();
  PSS_ASSIGN(tables, reserve_tables(source));
  return project(source, work);
}

Result<Reservation> SmoothRun::reserve_tables(const Store& store) {
  return budget_.take(store.table_memory(),
                      fmt::format("the table of {} tiles", store.tiles().size()));
}

/// The store that the inputs make, or the one that was given.
Result<Store> SmoothRun::sorted_input(const Job& started) {
  if (is_store_input(job_)) {
    PSS_ASSIGN(Store store, Store::open(job_.inputs.front()));
    PSS_TRY(check_unchanged(started.record().inputs));
    if (!store.complete())
      return Error{Fault::kBadInput,
                   fmt::format("{}: the store is not complete; run the command that makes it again",
                               store.path())};
    PSS_TRY(check_attributes(job_, store.header()));
    report_.ingest.points_read = report_.ingest.points_stored = store.points();
    return store;
  }
  PSS_TRY(sort_input(started));  // its plan, and the head in it, is gone before the store has one
  return Store::open(started.work().input_store());
}

Result<void> SmoothRun::sort_input(const Job& started) {
  const WorkDirectory& work = started.work();
  const Stopwatch planning;
  const IngestOptions options = ingest_options(job_);
  PSS_ASSIGN(const IngestPlan plan, plan_ingest(started.record().inputs, options, monitor_));
  PSS_TRY(check_attributes(job_, plan.header));
  PSS_TRY(check_least(job_, plan.header, plan.points, budget_));
  report_.notes.insert(report_.notes.end(), plan.notes.begin(), plan.notes.end());
  report_.plan_seconds = planning.seconds();
  const Stopwatch sorting;
  const Transfer before = transferred();
  PSS_ASSIGN(report_.ingest,
             ingest(plan, work.input_store(), work.path(), options, budget_, monitor_));
  report_.ingest_seconds = sorting.seconds();
  report_.ingest_transfer = transferred_since(before);
  return {};
}

Result<ChosenWidths> SmoothRun::choose(const Store& source) {
  const Stopwatch watch;
  const Transfer before = transferred();
  PSS_ASSIGN(ChosenWidths widths, choose_widths(source, job_.options.widths,
                                                method_of(job_.options), budget_, monitor_));
  report_.spacing_seconds = watch.seconds();
  report_.spacing_transfer = transferred_since(before);
  monitor_.note(widths.why);
  return widths;
}

/// Refuses what could not be finished.
Result<void> SmoothRun::check(const Store& source, const WorkDirectory& work) {
  PSS_ASSIGN(const std::uint64_t present, bytes_present(work));  // before an operator has a header
  PSS_ASSIGN(const ProjectOperator op, project_operator(source, job_, report_.widths, identity_));
  PSS_TRY(check_buffer(op, job_.options));
  PSS_ASSIGN(const std::string note, check_output_grid(source, job_, report_.widths, monitor_));
  if (!note.empty()) report_.notes.push_back(note);
  return check_space(source, op, work, present);
}

/// Runs an operator into a store of the work directory, or goes on with what is there.
Result<StoreWriter> SmoothRun::run_stage(const char* stage, const Store& source,
                                         const ProjectOperator& op, const std::string& path) {
  const StoreHeader& header = op.result_header();
  PSS_ASSIGN(StoreWriter result, is_store(path) ? StoreWriter::resume(path, header)
                                                : StoreWriter::create(path, header));
  if (result.complete()) return result;  // also where it was stopped while it was finished
  monitor_.begin(stage, source.points(), source.tiles().size());
  for (const TileInfo& tile : result.tiles()) monitor_.advance(tile.count, 1);
  PSS_ASSIGN(report_.schedule, run_operator(source, op, result, budget_, monitor_));
  if (header.inputs.count > 0) PSS_TRY(copy_inputs(source.path(), path));
  return result;
}

/// The first pass: the sorted input again, each point with a normal.
Result<void> SmoothRun::compute_normals(const Store& source, const WorkDirectory& work) {
  const Stopwatch watch;
  const Transfer before = transferred();
  PSS_ASSIGN(const ProjectOperator op, normals_operator(source, job_, report_.widths, identity_));
  PSS_ASSIGN(StoreWriter result, run_stage("normals", source, op, work.normals_store()));
  report_.normals_seconds = watch.seconds();
  report_.normals_transfer = transferred_since(before);
  return result.complete() ? Result<void>() : result.finish("{}");
}

Result<void> SmoothRun::project(const Store& source, const WorkDirectory& work) {
  const Stopwatch watch;
  const Transfer before = transferred();
  PSS_ASSIGN(const ProjectOperator op, project_operator(source, job_, report_.widths, identity_));
  PSS_ASSIGN(StoreWriter result, run_stage("smooth", source, op, work.result_store()));
  report_.smooth_seconds = watch.seconds();
  report_.smooth_transfer = transferred_since(before);
  return result.complete() ? Result<void>() : result.finish(result_summary(report_));
}

/// The stores that are still to be written must fit on the work directory's disk, and the output,
/// uncompressed at worst, on its own, which may be the same.
Result<void> SmoothRun::check_space(const Store& source, const ProjectOperator& op,
                                    const WorkDirectory& work, std::uint64_t present) const {
  const SmoothSpace space = smooth_space(job_, report_.normals, source, op);
  const std::string folder = directory_of(job_.output);
  const bool apart = !same_disk(work.path(), folder);
  if (apart)
    PSS_TRY(check_free(folder, 0, space.output, "for the output; write it to another disk"));
  return check_free(work.path(), present, space.most_more(!apart),
                    apart ? "for the result; use --work-dir on another disk"
                          : "for the result and the output; use --work-dir on another disk");
}

Result<void> SmoothRun::write(Job& started) {
  const WorkDirectory& work = started.work();
  const Stopwatch watch;
  const Transfer before = transferred();
  std::optional<Store> result;
  PSS_ASSIGN(result, Store::open(work.result_store()));
  read_result_summary(result->summary(), report_);
  report_.points_out = result->points();
  report_.tiles = result->tiles().size();
  report_.result_bytes = result->bytes_on_disk();
  for (const TileInfo& tile : result->tiles()) {
    PSS_ASSIGN(const auto statistics, ProjectStatistics::from_note(tile.note, result->path()));
    report_.statistics.add(statistics);
  }
  note_if_few_moved();
  if (is_store_name(job_.output)) {
    result.reset();
    PSS_TRY(started.hand_over_store(work.result_store()));
  } else {
    ExportOptions options = export_options(job_);
    options.rules = started.output_rules();
    PSS_ASSIGN(const ExportSummary written,
               export_store(*result, job_.output, options, budget_, monitor_));
    report_.notes.insert(report_.notes.end(), written.notes.begin(), written.notes.end());
    if (written.grid) report_.rounding_step = *std::ranges::max_element(written.grid->scale);
  }
  report_.write_seconds = watch.seconds();
  report_.write_transfer = transferred_since(before);
  return {};
}

/// Widths that reach too few neighbours, or too many, leave most points where they are.
void SmoothRun::note_if_few_moved() {
  const std::uint64_t moved = report_.statistics.moved();
  if (2 * moved >= report_.points_out) return;
  report_.notes.push_back(fmt::format(
      "only {} of {} points moved; the status says why, --radius, --h and --knn decide it", moved,
      report_.points_out));
}

void SmoothRun::describe_run() {
  report_.inputs = job_.inputs;
  report_.method = method_of(job_.options);
  report_.output = job_.output;
  report_.work_dir = places_.work_directory();
  report_.points_in = report_.ingest.points_read;
  report_.peak_memory = peak_resident();
  report_.memory_limit = budget_.limit();
  report_.threads = thread_count();
}

}  // namespace

Result<SmoothReport> smooth(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor) {
  return SmoothRun(job, budget, monitor).run();
}

}  // namespace pss
