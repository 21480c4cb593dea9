#pragma once
// A smoothing job in JSON: what its result store keeps of it.

#include <string>

#include "stream/jobs/smooth.h"

namespace pss {

/// Method and widths that a result was made with, and the identity_of() its job, for the result's
/// header: equal again when the job is resumed. Numbers and names alone: no sentence is compared.
std::string result_parameters(const SmoothJob& job, const ChosenWidths& widths,
                              const std::string& identity);
/// The identity in a result's header; empty where there is none.
std::string identity_in(const std::string& result_parameters);

/// What a report needs after the stages before writing are gone, and back again.
std::string result_summary(const SmoothReport& report);
void read_result_summary(const std::string& summary, SmoothReport& report);

}  // namespace pss
