#pragma once
// A noisy cloud of a known surface, the same for all that are compared, and the errors of results.

#include <span>
#include <vector>

#include "core/result.h"
#include "io/synth/synth_options.h"

namespace pss::bench {

/// What contenders smooth.
struct Points {
  double spacing = 0;
  Lattice lattice;
  std::vector<Index3> points;
};

/// Points of a known surface, in the order of a scanner or scattered, never in key order; their
/// coordinates are the same numbers in float, in double and on the lattice.
struct Cloud : Points {
  Surface surface;
};

/// Synthesises what `options` say, on a lattice that float holds exactly; their scale is ignored.
///
/// Errors: kUsage, as check(options) gives.
Result<Cloud> make_cloud(SynthOptions options);

/// How far results lie off the true surface.
struct Errors {
  double rms = 0;        ///< in spacings
  std::size_t lost = 0;  ///< results missing or not finite
};

/// Shape: `results` in any order.
Errors errors_of(const Cloud& cloud, std::span<const World3> results);

}  // namespace pss::bench
