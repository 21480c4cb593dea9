#pragma once
// How long the projection of a point takes on this machine, measured in a moment.

#include "core/method.h"

namespace pss {

/// Seconds of one thread a point, the search for its neighbours included.
///
/// Shape: `neighbours` is how many lie within the radius, on a surface.
/// Cost:  about a twentieth of a second, more for thousands of neighbours.
double seconds_per_point(const Method& method, double neighbours);

}  // namespace pss
