#pragma once
// Where the JSON report of a run goes, made sure of before the work begins.

#include <optional>
#include <span>
#include <string>

#include "core/result.h"
#include "io/file/output_lock.h"
#include "stream/jobs/job_request.h"

namespace pss {

/// What a report must keep clear of, and what it may replace.
struct ReportRules {
  std::string command;
  std::span<const std::string> inputs;
  std::string output;
  std::string work_dir;  ///< empty: none
  bool overwrite = false;
  std::span<const std::string> arguments = {};  ///< among which are lists of inputs
};

/// The report of one run: a file that appears when it is written, stdout, or nothing.
class ReportFile {
 public:
  /// `name` is a path, "-" for stdout, or empty for no report.
  ///
  /// An existing file is replaced where `overwrite` says so, and where it is a report of the same
  /// command on the same output: a finished job that is run again reports again.
  ///
  /// Errors: kUsage for an input or a list of them, the output, or what lies within a store or the
  ///         work directory; kFailed where the file exists, cannot be written, or another process
  ///         writes it.
  static Result<ReportFile> claim(const std::string& name, const ReportRules& rules);

  /// The same for a job; `arguments` are the words from which its inputs came.
  static Result<ReportFile> claim(const std::string& name, const std::string& command,
                                  const JobRequest& job, std::span<const std::string> arguments);

  bool to_stdout() const { return name_ == "-"; }
  Result<void> write(const std::string& json) const;

 private:
  explicit ReportFile(std::string name) : name_(std::move(name)) {}
  std::string name_;
  std::optional<OutputLock> lock_;
  bool replaces_ = false;
};

}  // namespace pss
