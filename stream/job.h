#pragma once
// A job's work directory: one process at a time, and a record of what the job is.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "io/file.h"
#include "io/file_lock.h"
#include "stream/manifest.h"
#include "stream/memory.h"

namespace pss {

/// What a work directory belongs to. Kept in WORKDIR/job.json.
struct JobRecord {
  std::string command;
  std::string output;
  std::string parameters;  ///< JSON object: all that the result depends on
  std::vector<InputRecord> inputs;
  bool complete = false;
  std::optional<InputRecord> result;  ///< OUTPUT, or its store's manifest, once written
};

/// Errors where `now` is another job than `then`: the first difference, by name.
Result<void> check_same_job(const JobRecord& then, const JobRecord& now,
                            const std::string& work_dir);

/// Whether the file at `path` is the one that the job wrote and recorded.
bool wrote(const JobRecord& record, const std::string& path);

/// The work directory of a running job, locked as long as this lives.
class WorkDirectory {
 public:
  /// Makes the directory where it is missing, and takes its lock.
  ///
  /// Errors: kFailed where another process holds the lock (with pid and host), or for I/O.
  static Result<WorkDirectory> open(const std::string& path);

  const std::string& path() const { return path_; }
  std::string input_store() const { return path_ + "/input.pss"; }
  std::string normals_store() const { return path_ + "/normals.pss"; }
  std::string result_store() const { return path_ + "/result.pss"; }

  /// The record, where there is one. Errors: kBadInput where it is damaged.
  Result<std::optional<JobRecord>> read_record() const;
  Result<void> write_record(const JobRecord& record) const;

  /// Removes what a job keeps here, the record last; nothing else that lies here is touched.
  Result<void> clear() const;
  /// Removes what a complete result was made from.
  Result<void> remove_sources() const;
  /// Removes all but the record.
  Result<void> remove_data() const;

 private:
  WorkDirectory(std::string path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  std::string path_;
  FileLock lock_;
};

/// Where a job reads, works and writes, and what it may do to what is there.
struct JobPlaces {
  std::vector<std::string> inputs;
  std::string output;
  std::string work_dir;
  bool overwrite = false;
  bool restart = false;
  bool keep_work = false;
};

/// Refuses places that would endanger each other, before anything is made: an output or an input
/// within the work directory, a work directory that holds somebody's files, a store's output on
/// another disk than the work directory, from where it could not be renamed.
///
/// Errors: kUsage; kFailed for a work directory that is none.
Result<void> check_places(const JobPlaces& places);

/// Takes what a job holds of its inputs' names, its record in JSON among it, for as long as it
/// runs.
///
/// Errors: kMemoryLimit, with the limit that would do for them.
Result<Reservation> reserve_names(const std::vector<std::string>& inputs, MemoryBudget& budget);

enum class Entry { kNew, kResumed, kComplete };

/// Finds out whether a job is new, to be resumed, complete, or another one; leaves its record.
///
/// Errors: kFailed where OUTPUT exists and is not this job's, or the directory holds another job.
Result<Entry> enter_job(const JobPlaces& places, const WorkDirectory& work, JobRecord& record);

/// Records a complete result, before it is renamed to OUTPUT: stopped in between, the job knows
/// its output again.
Result<void> record_result(const WorkDirectory& work, JobRecord& record, const std::string& file);

/// Gives a finished store in the work directory the name OUTPUT.
Result<void> hand_over_store(const std::string& store, const JobPlaces& places,
                             const WorkDirectory& work, JobRecord& record);

/// Leaves the record that tells the same command that all is done, and little else.
Result<void> leave_job(const JobPlaces& places, const WorkDirectory& work, JobRecord& record);

/// The record in a work directory, without locking it.
Result<std::optional<JobRecord>> read_job_record(const std::string& work_dir);
/// Who holds the lock of a work directory now: "process 123 on host".
std::optional<std::string> job_holder(const std::string& work_dir);

}  // namespace pss
