#pragma once
// Which projection a job's words mean, where they leave something open.

#include <nlohmann/json_fwd.hpp>

#include "core/method.h"

namespace pss {

struct SmoothOptions;

/// The precision where the user names none: double where the sums of the fit ask for it.
Precision default_precision(const Method& method);

/// The projection that options ask for.
Method method_of(const SmoothOptions& options);

/// Keys as docs/report.md has them; apss and rimls have no polynomial of the user's choice.
nlohmann::ordered_json method_json(const Method& method);

}  // namespace pss
