#pragma once
// Refuses, before any point is sorted, a smoothing job whose outputs and the attributes of its
// inputs cannot both be in its result.

#include "core/result.h"
#include "stream/jobs/smooth.h"
#include "stream/store/manifest.h"

namespace pss {

/// `source` is what the sorted input has or will have: the attributes of all inputs.
///
/// Errors: kUsage, naming the input, where an output would take the place of one of its attributes
///         and the job does not say that it may; kBadInput where the attributes and the outputs
///         together are more than the output can hold.
Result<void> check_attributes(const SmoothJob& job, const StoreHeader& source);

}  // namespace pss
