#pragma once
// Where a job keeps its work: a directory that is pss's own, used by one process at a time.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "io/file/output_lock.h"
#include "stream/jobs/job_record.h"

namespace pss {

/// Refuses, touching nothing, a directory that is there and not pss's own. It is, where it holds a
/// whole record of a job, or nothing but what is left of a process that was killed before it had
/// written one.
///
/// Errors: kFailed; kBadInput where the record is damaged or of another version.
Result<void> check_work_directory(const std::string& path);

/// The stores that a job keeps in its work directory: its sorted input, what a pass makes, and one
/// that had OUTPUT's name, on its way to be removed.
std::string input_store_in(const std::string& work_dir);
std::string pass_store_in(const std::string& work_dir, std::string_view pass);
std::string replaced_store_in(const std::string& work_dir);

/// The record in a work directory, without locking it; empty where there is none.
Result<std::optional<JobRecord>> read_job_record(const std::string& work_dir);
/// Who holds the lock of a work directory now: "process 123 on host".
std::optional<std::string> job_holder(const std::string& work_dir);

/// The work directory of a running job, locked as long as this lives.
class WorkDirectory {
 public:
  /// Makes the directory where it is missing, and takes its lock.
  ///
  /// Errors: those of check_work_directory(); kFailed where another process holds the lock (with
  ///         pid and host), where a link has the name of something that a job keeps here, for I/O.
  static Result<WorkDirectory> open(const std::string& path);

  const std::string& path() const { return path_; }
  bool made() const { return made_; }  ///< by open(): it was not there
  std::string runs() const { return path_ + "/runs"; }
  std::string input_store() const { return input_store_in(path_); }
  std::string pass_store(std::string_view pass) const { return pass_store_in(path_, pass); }
  std::string replaced_store() const { return replaced_store_in(path_); }
  /// The store of the last pass that the record names; of a job without one the sorted input.
  std::string result_store(const JobRecord& record) const;

  Result<std::optional<JobRecord>> read_record() const { return read_job_record(path_); }
  Result<void> write_record(const JobRecord& record) const;

  // What there is of the job of this record.

  /// Whether any points are sorted or computed: work that is worth going on with.
  bool has_work(const JobRecord& record) const;
  /// Whether any tile has come from a pass over the sorted points.
  bool has_results(const JobRecord& record) const;

  /// Makes sure that a directory made here can be renamed to `to`, which is free.
  Result<void> probe_rename(const std::string& to) const;

  /// Removes what was made from the sorted points.
  Result<void> remove_results(const JobRecord& record) const;
  /// Removes the store that had OUTPUT's name.
  Result<void> remove_replaced() const;
  /// Removes what a complete result was made from.
  Result<void> remove_sources(const JobRecord& record) const;
  /// Removes all that the job keeps here but the record, and nothing else.
  Result<void> remove_data(const JobRecord& record) const;
  /// Removes all that the job keeps here, the record last.
  Result<void> clear(JobRecord record) const;
  /// The same, and the directory, where nothing else lies in it.
  static Result<void> remove(WorkDirectory work, const JobRecord& record);
  /// Ends its lock, and removes the directory where nothing lies in it.
  static void remove_empty(WorkDirectory work);

 private:
  WorkDirectory(std::string path, OutputLock lock, bool made)
      : path_(std::move(path)), lock_(std::move(lock)), made_(made) {}
  Result<void> check_names() const;
  std::string path_;
  OutputLock lock_;  ///< on the record
  bool made_ = false;
};

}  // namespace pss
