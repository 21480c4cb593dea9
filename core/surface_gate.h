#pragma once
// Whether a point that was projected has a surface about it, by what the fit left over.

#include "core/method.h"
#include "core/projection.h"

namespace pss {

/// Points on a surface leave a residual of their noise alone; in vegetation and scatter it is a
/// large share of the width.
class SurfaceGate {
 public:
  /// Of projections with this method and supports of this radius over h.
  SurfaceGate(const Method& method, double radius_over_h);

  /// The residual with its degrees of freedom, residual / sqrt(1 - K / n): what the neighbours'
  /// distances to a surface that is not fitted to them would be. Below 1.4 K neighbours n the
  /// correction is that of 1.4 K.
  ///
  /// Requires: moved(projection.status).
  /// Units:    those of the positions.
  /// Source:   the trace of the hat matrix, as in FitKernel::absorbed().
  double residual(const Projection& projection) const;

 private:
  double parameters_;  ///< K: how many the fit spends
};

}  // namespace pss
