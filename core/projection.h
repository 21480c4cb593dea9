#pragma once
// How wide the projection of one point onto the MLS surface looks, and what it gives.

#include <cstdint>

#include "core/lattice.h"
#include "core/method.h"
#include "core/status.h"

namespace pss {

/// How wide a query looks: the Gaussian's width and the distance at which its weight is zero.
struct Support {
  double h = 0;
  double radius = 0;
};

/// How far from the query a projection may look: the foot point stays within h/2 of it.
constexpr double reach(const Support& support) { return support.radius + support.h / 2; }

/// The same for a weight; that of PCL is cut off about the query.
constexpr double reach(WeightKind weight, const Support& support) {
  return weight == WeightKind::kPcl ? support.radius : reach(support);
}

/// The default radius for a width: 3 h, and 4 h for degree 4.
constexpr double radius_factor(int degree) { return degree == 4 ? 4.0 : 3.0; }

/// What the projection of one point gives.
struct Projection {
  Status status = Status::kTooFew;
  bool second_sheet = false;     ///< another sheet lies within the neighbourhood
  bool redone = false;           ///< in double precision, where single was asked for
  std::uint32_t neighbours = 0;  ///< points with |p - q| < radius about the foot point q
  World3 displacement{0, 0, 0};  ///< P(r) - r; zero where the point stays
  World3 normal{0, 0, 0};        ///< unit, largest component positive; zero where there is none
  double mean_curvature = 0;     ///< positive where the surface bends towards the normal
  double gaussian_curvature = 0;
  World3 principal_direction{0, 0, 0};  ///< unit tangent of the larger principal curvature,
                                        ///< canonical sign; zero where both are equal
  double residual = 0;  ///< weighted rms distance of the neighbours to the fitted polynomial
  double boundary = 0;  ///< |weighted mean - q| / weighted rms distance: 0 inside, 0.56 on an edge
};

}  // namespace pss
