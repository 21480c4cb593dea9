#pragma once
// What follows from a smoothing job's words alone: names, parameters, operator, checks.

#include <string>

#include "core/result.h"
#include "stream/jobs/job.h"
#include "stream/jobs/smooth.h"
#include "stream/operators/project.h"
#include "stream/store/export.h"

namespace pss {

/// Errors: kUsage for options that contradict each other or make no sense.
Result<void> check_job(const SmoothJob& job);

/// Whether the job's input is a store.
bool is_store_input(const SmoothJob& job);
/// Whether a finished store lies there.
bool is_complete_store(const std::string& path);

JobPlaces places_of(const SmoothJob& job);

/// The record that the job's work directory gets. Errors: kFailed for inputs that cannot be read.
Result<JobRecord> job_record(const SmoothJob& job);

/// Refuses, before anything is measured, a grid that cannot hold the sorted points as they are.
Result<void> check_output_box(const Store& source, const SmoothJob& job);
ExportOptions export_options(const SmoothJob& job);
/// How the job's files are sorted.
IngestOptions ingest_options(const SmoothJob& job);
/// Refuses what the job's output could not hold, with all the room that moves need; returns what
/// should be known of it. Errors: those of check_export().
Result<std::string> check_output_grid(const Store& source, const SmoothJob& job,
                                      const ChosenWidths& widths, Monitor& monitor);
/// The job's operator over its sorted input, for a result that says whose it is: identity_of() the
/// job.
Result<ProjectOperator> project_operator(const Source& source, const SmoothJob& job,
                                         const ChosenWidths& widths, const std::string& identity);
/// The job's first pass over its sorted input, where its operator needs normals and that has none.
Result<ProjectOperator> normals_operator(const Source& source, const SmoothJob& job,
                                         const ChosenWidths& widths, const std::string& identity);
/// Errors: kUsage where --buffer is less than exactness needs and --allow-inexact is missing.
Result<void> check_buffer(const ProjectOperator& op, const SmoothOptions& options);

}  // namespace pss
