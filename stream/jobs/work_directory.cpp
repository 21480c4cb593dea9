#include "stream/jobs/work_directory.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/file/disk.h"
#include "io/file/file.h"
#include "stream/sort/run_log.h"
#include "stream/store/manifest.h"
#include "stream/store/store.h"
#include "stream/store/store_writer.h"

namespace pss {
namespace {

constexpr std::uint64_t kLargestRecord = 64u << 20;

/// Whether a job may make a directory of this name.
bool is_of_a_job(const std::string& name) {
  return name == "runs" || name == "probe" || is_store_name(name);
}

std::string record_path(const std::string& work_dir) { return work_dir + "/job.json"; }

std::string name_in(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

/// The lock of a record and its temporary, which has a number in its name:
/// ".job.json.123.pss-part".
bool is_before_record(const std::string& name) {
  constexpr std::string_view kStart = ".job.json.", kEnd = ".pss-part";
  if (name == name_in(lock_name_of(record_path("")))) return true;
  if (!name.starts_with(kStart) || !name.ends_with(kEnd)) return false;
  const std::size_t digits = name.size() - kStart.size() - kEnd.size();
  return name.find_first_not_of("0123456789", kStart.size()) == kStart.size() + digits;
}

/// Whether a store has any tile, or cannot be read, so that nobody can tell.
bool has_tiles(const std::string& path) {
  if (!is_store(path)) return false;
  const Result<Store> store = Store::open(path);
  return !store || !store->tiles().empty();
}

}  // namespace

std::string input_store_in(const std::string& work_dir) { return work_dir + "/input.pss"; }

std::string pass_store_in(const std::string& work_dir, std::string_view pass) {
  return fmt::format("{}/{}.pss", work_dir, pass);
}

std::string replaced_store_in(const std::string& work_dir) { return work_dir + "/replaced.pss"; }

Result<std::optional<JobRecord>> read_job_record(const std::string& work_dir) {
  const std::string path = record_path(work_dir);
  if (!exists(path)) return std::optional<JobRecord>();
  PSS_ASSIGN(const std::vector<std::byte> bytes, read_whole(path, kLargestRecord));
  PSS_ASSIGN(JobRecord record, job_record_from(path, bytes));
  return std::optional(std::move(record));
}

std::optional<std::string> job_holder(const std::string& work_dir) {
  return lock_holder(record_path(work_dir));
}

Result<void> check_work_directory(const std::string& path) {
  if (!exists(path)) return {};
  if (exists(record_path(path))) {
    const auto record = read_job_record(path);
    return record ? Result<void>() : record.error();
  }
  PSS_ASSIGN(const std::vector<std::string> names, list_directory(path));
  for (const std::string& name : names)
    if (!is_before_record(name))
      return Error{Fault::kFailed,
                   fmt::format("{}: found {}, expected an empty or new work directory, or one with "
                               "the record of a job; use another --work-dir",
                               path, name)};
  return {};
}

Result<WorkDirectory> WorkDirectory::open(const std::string& path) {
  PSS_TRY(check_work_directory(path));
  const bool made = !exists(path);
  PSS_TRY(make_directories(path));
  PSS_ASSIGN(OutputLock lock, OutputLock::take(record_path(path)));
  WorkDirectory work(path, std::move(lock), made);
  PSS_TRY(check_work_directory(path));  // again: now nobody else changes it
  PSS_TRY(work.check_names());
  return work;
}

/// A link could lead to anybody's directory.
Result<void> WorkDirectory::check_names() const {
  PSS_ASSIGN(const std::vector<std::string> names, list_directory(path_));
  for (const std::string& name : names) {
    if (!is_of_a_job(name)) continue;
    disk::Status status;
    const std::string place = fmt::format("{}/{}", path_, name);
    const disk::Outcome outcome = disk::status(place, disk::Links::kKeep, status);
    if (outcome < 0 || status.kind == disk::Kind::kDirectory) continue;
    return Error{Fault::kFailed,
                 fmt::format("{}: found a link or a file, expected a directory that the job makes; "
                             "move it elsewhere, or use another --work-dir",
                             place)};
  }
  return {};
}

Result<void> WorkDirectory::write_record(const JobRecord& record) const {
  const std::string text = to_text(record);
  const Result<void> replaced =
      replace_file(lock_.path(), {std::as_bytes(std::span(text))}, lock_.temporary());
  // Its lock goes with this process, and then nobody would know whose it is.
  if (!replaced) disk::remove_file(lock_.temporary());
  return replaced;
}

std::string WorkDirectory::result_store(const JobRecord& record) const {
  return record.passes.empty() ? input_store() : pass_store(record.passes.back());
}

bool WorkDirectory::has_results(const JobRecord& record) const {
  return std::ranges::any_of(record.passes, has_tiles,
                             [this](const std::string& pass) { return pass_store(pass); });
}

bool WorkDirectory::has_work(const JobRecord& record) const {
  return has_runs(runs()) || is_store(input_store()) ||
         std::ranges::any_of(record.passes, is_store,
                             [this](const std::string& pass) { return pass_store(pass); });
}

Result<void> WorkDirectory::probe_rename(const std::string& to) const {
  const std::string probe = path_ + "/probe";
  const auto nothing = [](const std::string&) { return false; };
  PSS_TRY(remove_own_directory(probe, nothing));  // left from a kill: it is empty
  PSS_TRY(make_own_directory(probe));
  const Result<void> renamed = rename_to_free_name(probe, to);
  PSS_TRY(remove_own_directory(exists(probe) ? probe : to, nothing));
  return renamed;
}

Result<void> WorkDirectory::remove_results(const JobRecord& record) const {
  for (const std::string& pass : record.passes) PSS_TRY(remove_store_files(pass_store(pass)));
  return {};
}

Result<void> WorkDirectory::remove_replaced() const { return remove_store_files(replaced_store()); }

Result<void> WorkDirectory::remove_sources(const JobRecord& record) const {
  if (record.passes.empty()) return {};  // the sorted input is the result
  PSS_TRY(remove_runs(runs()));
  PSS_TRY(remove_store_files(input_store()));
  for (const std::string& pass : record.passes)
    if (pass != record.passes.back()) PSS_TRY(remove_store_files(pass_store(pass)));
  return {};
}

Result<void> WorkDirectory::remove_data(const JobRecord& record) const {
  PSS_TRY(remove_runs(runs()));
  PSS_TRY(remove_store_files(input_store()));
  PSS_TRY(remove_results(record));
  for (const std::string& store : {replaced_store(), path_ + "/probe"})
    PSS_TRY(remove_store_files(store));
  return {};
}

Result<void> WorkDirectory::clear(JobRecord record) const {
  // Order: first the record says that the data goes, and it goes itself only after it. So a power
  // cut leaves neither half a store that looks damaged nor data that belongs to no job.
  record.discarding = true;
  PSS_TRY(write_record(record));
  PSS_TRY(remove_data(record));
  PSS_TRY(sync_directory(path_));
  PSS_TRY(remove_file(record_path(path_)));
  return sync_directory(path_);
}

Result<void> WorkDirectory::remove(WorkDirectory work, const JobRecord& record) {
  PSS_TRY(work.clear(record));
  remove_empty(std::move(work));
  return {};
}

void WorkDirectory::remove_empty(WorkDirectory work) {
  const std::string path = work.path_;
  { const OutputLock last = std::move(work.lock_); }
  disk::remove_directory(path);  // stays where something else lies in it
}

}  // namespace pss
