#pragma once
// Runs a job of any kind: sorts its input, runs its passes, hands over its result.

#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/jobs/job_kind.h"
#include "stream/jobs/job_report.h"
#include "stream/jobs/job_request.h"
#include "stream/limit/memory.h"
#include "stream/sort/ingest.h"

namespace pss {

/// Runs the job, or goes on with it, or says that it is complete.
///
/// Errors: as in the table of exit codes; nothing is left under OUTPUT's name unless complete.
Result<JobReport> run_job(const JobRequest& request, JobKind& kind, MemoryBudget& budget,
                          Monitor& monitor);

/// How the job's files are sorted.
///
/// Errors: kUsage for an output of no known format.
Result<IngestOptions> ingest_options(const JobRequest& request, const JobKind& kind);

/// What a report needs of all before the writing, as the result's store keeps it, and back again.
std::string result_summary(const JobReport& report, const JobKind& kind);
/// What is of another type, or of another version of pss, stays unknown.
void read_result_summary(const std::string& summary, JobReport& report, JobKind& kind);

}  // namespace pss
