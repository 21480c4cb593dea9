#pragma once
// The chosen widths in JSON: for reports, and for the state of a job.

#include <nlohmann/json_fwd.hpp>

#include "stream/widths/widths.h"

namespace pss {

/// Keys as docs/report.md has them.
nlohmann::ordered_json widths_json(const ChosenWidths& widths);
/// What widths_json() wrote; what is missing takes its default.
ChosenWidths widths_from_json(const nlohmann::ordered_json& json);

}  // namespace pss
