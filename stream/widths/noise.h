#pragma once
// How noisy the points of a source are, and how wide a fit may look before it bends the surface.

#include <cstddef>
#include <vector>

#include "core/method.h"
#include "core/monitor.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/source.h"
#include "stream/widths/spacing.h"
#include "stream/widths/width_trials.h"

namespace pss {

/// What the sample shows at one width. Lengths in spacings.
struct WidthTrial {
  double width = 0;     ///< h
  bool known = false;   ///< whether enough of the sample is usable for what follows
  double usable = 0;    ///< share of the sample that is determined and inside, not at a boundary
  double residual = 0;  ///< noise by the median residual, the fit's share given back
  double bend = 0;      ///< h times the larger principal curvature: 90 % of the sample is below
  double change = 0;    ///< rms change of the projection up to the next width; 0 at the last
  double noise_change = 0;  ///< what noise of one spacing would make of it
};

/// What a sample of a source shows of noise and shape. Lengths in spacings: those of the source, or
/// where the spacing varies each point's own.
struct Noise {
  std::size_t sample = 0;  ///< sampled positions that were looked at
  double sigma = 0;        ///< standard deviation along the normal, where a surface is seen
  int first = -1;          ///< the number of the narrowest width that sees a surface; -1: none
  double kept = 0;         ///< of the noise in a fit at h = 1: it falls as 1/h
  int order = 4;           ///< the power of h at which fits depart from the shape
  double apart = 0;        ///< a tenth of the sample sees another sheet nearer than this; 0: none
  std::vector<WidthTrial> trials;
};

/// What try_widths() tells.
///
/// Requires: `sample` has a spacing.
/// Errors:   those of try_widths().
Result<Noise> measure_noise(const Source& source, const SpacingSample& sample, const Method& method,
                            MemoryBudget& budget, Monitor& monitor);

}  // namespace pss
