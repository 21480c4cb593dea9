#pragma once
// What a smooth job did, or would do, in words.

#include <string>
#include <vector>

#include "stream/jobs/smooth.h"

namespace pss {

/// A few lines for the end of a run.
std::vector<std::string> summary_lines(const SmoothReport& report);

/// A table for --dry-run.
std::string estimate_text(const SmoothEstimate& estimate);

}  // namespace pss
