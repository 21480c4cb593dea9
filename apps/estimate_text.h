#pragma once
// What a job would take, as lines for people: the answer of --dry-run.

#include <string>

#include "apps/report_file.h"
#include "core/result.h"
#include "stream/jobs/job_estimate.h"

namespace pss {

/// A name and a value, as each line has them.
std::string estimate_line(const char* name, const std::string& value);

/// The lines that all kinds of jobs have.
std::string estimate_text(const JobEstimate& estimate);

/// The answer: `text` on stdout, unless the report goes there, and the report.
Result<void> tell_estimate(const ReportFile& report, const std::string& text,
                           const std::string& json);

}  // namespace pss
