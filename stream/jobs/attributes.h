#pragma once
// Refuses, before any point is sorted, a job whose attributes cannot all be in its result.

#include "core/result.h"
#include "stream/jobs/job_kind.h"
#include "stream/jobs/job_request.h"
#include "stream/passes/outputs.h"
#include "stream/store/manifest.h"

namespace pss {

/// `source` is what the sorted input has or will have: the attributes of all inputs.
///
/// Errors: those of JobKind::check_source(); kBadInput where the attributes of the result are more
///         than the output can hold.
Result<void> check_attributes(const JobRequest& request, const JobKind& kind,
                              const StoreHeader& source);

/// Refuses outputs that would take the place of attributes of the inputs.
///
/// Errors: kUsage, naming the input and a way out; those of opening inputs.
Result<void> check_clashes(const JobRequest& request, const Schema& source, OutputSet outputs);

}  // namespace pss
