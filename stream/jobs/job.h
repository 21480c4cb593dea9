#pragma once
// A job from its start to its end: what it may do with the places it was given, and what it leaves.

#include <optional>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "io/file/output_file.h"
#include "io/file/output_lock.h"
#include "stream/jobs/job_record.h"
#include "stream/jobs/job_request.h"
#include "stream/jobs/work_directory.h"

namespace pss {

/// A job that runs: it has the locks on OUTPUT and on its work directory.
class Job {
 public:
  /// Finds out whether the job is new, to be resumed, complete, or another one; leaves its record.
  ///
  /// Requires: check_places() has found nothing.
  /// Errors:   those of the locks; kFailed where OUTPUT exists and is not this job's, or the
  ///           directory holds another job.
  static Result<Job> enter(const JobRequest& request, JobRecord record, Monitor& monitor);

  bool complete() const { return complete_; }  ///< OUTPUT is there, as this job writes it
  bool resumed() const { return resumed_; }
  const JobRecord& record() const { return record_; }
  /// Requires: not complete().
  const WorkDirectory& work() const { return *work_; }

  /// Names a pass in the record, where that does not know it yet, before its store is made.
  Result<void> begin_pass(const std::string& name);
  /// Records that no further pass comes, where that was not known yet.
  Result<void> end_passes();
  /// Removes what the complete result was made from, unless it is to be kept.
  Result<void> drop_sources() const;

  /// The rules by which OUTPUT is written as a file. Requires: this stays where it is meanwhile.
  OutputRules output_rules();
  /// Gives a finished store in the work directory the name OUTPUT.
  Result<void> hand_over_store(const std::string& store);

  /// After success: leaves OUTPUT, and what tells the same command that all is done.
  Result<void> leave();
  /// After a failure: leaves nothing where nothing was sorted; else what the same command goes on
  /// with, or why it begins again, where an input has changed while it was read. Gives `why` back.
  Error fail(Error why);

 private:
  Job(const JobRequest& request, JobRecord record, OutputLock lock, Monitor& monitor);
  Result<bool> is_complete();
  Result<bool> has_content(const FileContent& content) const;
  Result<void> put_back();
  void note_changed_input();
  Error with_remedy(Error why) const;
  Result<void> check_output_name() const;
  Result<void> open_work();
  Result<void> check_rename() const;
  Result<void> take_over(const JobRecord& before);
  void take_passes(const JobRecord& before);
  Result<void> replace_store(const std::string& store);
  JobRequest request_;
  JobRecord record_;
  OutputLock lock_;
  std::optional<WorkDirectory> work_;
  Monitor* monitor_;
  bool complete_ = false;
  bool entered_ = false;  ///< the work directory's record is this job's
  bool resumed_ = false;
};

}  // namespace pss
