#pragma once
// A smoothing job in JSON: what its result store keeps of it.

#include <string>

#include "stream/smooth.h"

namespace pss {

/// The widths a result was made with, for the result's header: equal again when a job is resumed.
std::string result_parameters(const SmoothJob& job, const ChosenWidths& widths);

/// What a report needs after the stages before writing are gone, and back again.
std::string result_summary(const SmoothReport& report);
void read_result_summary(const std::string& summary, SmoothReport& report);

}  // namespace pss
