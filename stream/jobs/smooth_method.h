#pragma once
// Which projection a job's words mean, where they leave something open.

#include "core/method.h"

namespace pss {

struct SmoothOptions;

/// The precision where the user names none: double where the sums of the fit ask for it.
Precision default_precision(const Method& method);

/// The projection that options ask for.
Method method_of(const SmoothOptions& options);

}  // namespace pss
