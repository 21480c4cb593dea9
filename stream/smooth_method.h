#pragma once
// Which projection a job's words mean, where they leave something open.

#include "core/method.h"

namespace pss {

struct SmoothOptions;

/// The degree of the fit that describes a surface found by apss or rimls, and of the one that gives
/// them normals: a plane's noise, without a plane's bias where the surface bends.
inline constexpr int kNormalsDegree = 2;

/// The precision where the user names none: double where the sums of the fit ask for it.
Precision default_precision(const Method& method);

/// The projection that options ask for.
Method method_of(const SmoothOptions& options);

/// The projection that gives the points the normals that `method` needs and the input lacks.
Method normals_method(const Method& method);

}  // namespace pss
