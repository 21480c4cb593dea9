#include "stream/jobs/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/file/file.h"
#include "stream/jobs/finished.h"
#include "stream/store/manifest.h"
#include "stream/store/store_writer.h"
#include "stream/store/verify.h"

namespace pss {
namespace {

Error other_job(const std::string& work_dir, const std::string& difference) {
  return {Fault::kFailed,
          fmt::format("{}: holds another job: {}; use --restart to discard it, or another "
                      "--work-dir",
                      work_dir, difference)};
}

/// The file by which an output is known again: itself, or a store's manifest.
std::string witness_of(const std::string& output) {
  return is_store_name(output) ? manifest_path(output) : output;
}

}  // namespace

Job::Job(const JobRequest& request, JobRecord record, OutputLock lock, Monitor& monitor)
    : request_(request), record_(std::move(record)), lock_(std::move(lock)), monitor_(&monitor) {}

Result<Job> Job::enter(const JobRequest& request, JobRecord record, Monitor& monitor) {
  PSS_ASSIGN(OutputLock lock, OutputLock::take(request.output));
  Job job(request, std::move(record), std::move(lock), monitor);
  PSS_ASSIGN(job.complete_, job.is_complete());
  if (job.complete_) {
    PSS_TRY(job.leave());
    return job;
  }
  PSS_TRY(job.put_back());
  PSS_TRY(job.check_output_name());
  if (auto opened = job.open_work(); !opened) return job.fail(std::move(opened).error());
  return job;
}

/// Whether OUTPUT is what this very job made of these very inputs, by the record in the work
/// directory, or, where that is gone, by the one in the state folder.
Result<bool> Job::is_complete() {
  if (request_.restart) return false;
  PSS_ASSIGN(const std::optional<JobRecord> before, read_job_record(request_.work_directory()));
  if (before) {
    if (!before->result || !difference(*before, record_).empty()) return false;
    PSS_ASSIGN(const bool there, has_content(*before->result));
    if (!there) return false;
    PSS_ASSIGN(WorkDirectory work, WorkDirectory::open(request_.work_directory()));
    work_.emplace(std::move(work));
    record_.result = before->result;
    take_passes(*before);
    return true;
  }
  const auto finished = recall_finished(request_.state_folder, request_.output);
  if (!finished || finished->identity != identity_of(record_)) return false;
  PSS_ASSIGN(const bool there, has_content(finished->content));
  if (there) record_.result = finished->content;
  // Killed between its record and its directory: what is left goes now.
  if (there && request_.work_dir.empty() && exists(request_.work_directory())) {
    PSS_ASSIGN(WorkDirectory work, WorkDirectory::open(request_.work_directory()));
    work_.emplace(std::move(work));
  }
  return there;
}

/// Where names cannot be exchanged, a kill between two renames leaves the old store in the work
/// directory alone: it gets its name back before anything else may happen to it.
Result<void> Job::put_back() {
  const std::string replaced = replaced_store_in(request_.work_directory());
  if (!has_manifest(replaced) || exists(request_.output)) return {};
  PSS_ASSIGN(const WorkDirectory work, WorkDirectory::open(request_.work_directory()));
  return rename_to_free_name(replaced, request_.output);
}

Result<bool> Job::has_content(const FileContent& content) const {
  const std::string witness = witness_of(request_.output);
  const auto now = fingerprint(witness);
  if (!now || now->size != content.size) return false;
  monitor_->begin("check", 0);
  PSS_ASSIGN(const FileContent found, content_of(witness, *monitor_));
  if (!same_bytes(found, content)) return false;
  if (!is_store_name(request_.output)) return true;
  const Result<void> whole = check_bytes(request_.output, *monitor_);
  if (!whole && whole.error().fault == Fault::kInterrupted) return whole.error();
  return whole.has_value();
}

Result<void> Job::check_output_name() const {
  if (!is_store_name(request_.output))
    return check_replaceable(request_.output, request_.overwrite);
  if (exists(request_.output) && !request_.overwrite)
    return Error{Fault::kFailed,
                 fmt::format("{}: exists; use --overwrite to replace it", request_.output)};
  return check_removable(request_.output);
}

Result<void> Job::open_work() {
  PSS_ASSIGN(WorkDirectory work, WorkDirectory::open(request_.work_directory()));
  work_.emplace(std::move(work));
  PSS_ASSIGN(const std::optional<JobRecord> before, work_->read_record());
  if (before) PSS_TRY(take_over(*before));
  PSS_TRY(work_->write_record(record_));
  entered_ = true;
  return is_store_name(request_.output) ? check_rename() : Result<void>();
}

/// Mounts may lie between two folders of one disk.
Result<void> Job::check_rename() const {
  const Result<void> renamed = work_->probe_rename(lock_.temporary());
  if (renamed) return {};
  return Error{Fault::kFailed,
               fmt::format("{}: no store can be renamed to it from its work directory: {}; use "
                           "another --work-dir",
                           request_.output, renamed.error().message)};
}

/// Goes on with what an earlier job left, or discards it.
Result<void> Job::take_over(const JobRecord& before) {
  // A complete job here has lost its output, or is to be done again.
  if (request_.restart || before.discarding) return work_->clear(before);
  if (before.complete && (!work_->has_work(before) || difference(before, record_).empty()))
    return work_->clear(before);
  if (!before.spoiled.empty()) {
    monitor_->note(
        fmt::format("begins again, because of what ended it before: {}", before.spoiled));
    return work_->clear(before);
  }
  // What is sorted serves other parameters as well, as long as nothing is computed with the first.
  const bool sorted_only = !work_->has_results(before) && !before.result;
  const std::string other =
      sorted_only ? sorting_difference(before, record_) : difference(before, record_);
  if (!other.empty()) return other_job(work_->path(), other);
  if (sorted_only) {
    PSS_TRY(work_->remove_results(before));
  } else {
    take_passes(before);
  }
  record_.result = before.result;
  resumed_ = true;
  return {};
}

/// An earlier run with equal parameters named the same passes, or more.
void Job::take_passes(const JobRecord& before) {
  record_.passes = before.passes;
  record_.may_grow = before.may_grow;
}

Result<void> Job::begin_pass(const std::string& name) {
  if (std::ranges::find(record_.passes, name) != record_.passes.end()) return {};
  record_.passes.push_back(name);
  return work_->write_record(record_);
}

Result<void> Job::end_passes() {
  if (!record_.may_grow) return {};
  record_.may_grow = false;
  return work_->write_record(record_);
}

Result<void> Job::drop_sources() const {
  return request_.keep_work ? Result<void>() : work_->remove_sources(record_);
}

OutputRules Job::output_rules() {
  return {request_.overwrite, &lock_, [this](const WrittenFile& written) {
            record_.result = written.content;
            return work_->write_record(record_);
          }};
}

Result<void> Job::hand_over_store(const std::string& store) {
  // What lay here since an earlier run has been read by nobody since.
  if (resumed_) PSS_TRY(check_bytes(store, *monitor_));
  // Recorded before it is renamed: stopped in between, the job knows its output again.
  PSS_ASSIGN(record_.result, content_of(manifest_path(store), *monitor_));
  PSS_TRY(work_->write_record(record_));
  if (!exists(request_.output) || !request_.overwrite)
    return rename_to_free_name(store, request_.output);
  PSS_TRY(check_removable(request_.output));
  return replace_store(store);
}

/// The old store goes into the work directory, and from there once all is done.
Result<void> Job::replace_store(const std::string& store) {
  PSS_ASSIGN(const bool exchanged, exchange_names(store, request_.output));
  if (exchanged) return rename_to_free_name(store, work_->replaced_store());
  PSS_TRY(rename_to_free_name(request_.output, work_->replaced_store()));
  const Result<void> renamed = rename_to_free_name(store, request_.output);
  if (!renamed) PSS_TRY(rename_to_free_name(work_->replaced_store(), request_.output));
  return renamed;
}

Result<void> Job::leave() {
  record_.complete = true;
  if (!request_.work_dir.empty() || request_.keep_work) {
    if (!work_) return {};
    PSS_TRY(work_->write_record(record_));
    return request_.keep_work ? work_->remove_replaced() : work_->remove_data(record_);
  }
  if (!work_) return {};
  // Order: it is remembered that OUTPUT is complete before the record here that says so goes.
  const FinishedOutput finished{identity_of(record_), *record_.result};
  const auto remembered = request_.state_folder.empty()
                              ? Error{Fault::kFailed, "no state folder is known"}
                              : remember_finished(request_.state_folder, request_.output, finished);
  if (!remembered)
    monitor_->note(fmt::format("the same command will not know that {} is complete: {}",
                               request_.output, remembered.error().message));
  Result<void> removed = WorkDirectory::remove(*std::move(work_), record_);
  work_.reset();
  return removed;
}

/// What cannot be read now may be as it was: only what has changed spoils what is sorted.
void Job::note_changed_input() {
  for (const InputRecord& input : record_.inputs) {
    const Result<void> unchanged = check_unchanged(input);
    if (unchanged || !fingerprint(input.path)) continue;
    record_.spoiled = unchanged.error().message;
    static_cast<void>(work_->write_record(record_));
    return;
  }
}

/// Of damage in the work directory: what it holds can be made again.
Error Job::with_remedy(Error why) const {
  const bool here = why.message.starts_with(request_.work_directory() + "/");
  const bool names_it = why.message.find("--restart") != std::string::npos;
  if (here && !names_it && why.fault == Fault::kBadInput)
    why.message += "; use --restart to make it again";
  return why;
}

Error Job::fail(Error why) {
  why = with_remedy(std::move(why));
  if (!work_) return why;
  if (!entered_) {  // the directory may hold another job
    if (work_->made()) WorkDirectory::remove_empty(*std::move(work_));
    work_.reset();
    return why;
  }
  const bool handed_over = record_.result && exists(request_.output);
  if (!work_->has_work(record_) && !handed_over) {
    const bool users = !request_.work_dir.empty() && !work_->made();  // an empty folder, before
    static_cast<void>(users ? work_->clear(record_)
                            : WorkDirectory::remove(*std::move(work_), record_));
    work_.reset();
  } else if (why.fault != Fault::kInterrupted && record_.spoiled.empty()) {
    note_changed_input();
  }
  return why;
}

}  // namespace pss
