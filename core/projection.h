#pragma once
// What the projection of one point onto the MLS surface needs and gives.

#include <cstdint>

#include "core/method.h"
#include "core/neighbours.h"
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

/// Projects the point at offset zero: `levin` or `fast` in double precision, one point after the
/// other, as docs/algorithm.md reads. The plain form that the kernels behind Projector are checked
/// against; jobs do not use it.
///
/// Shape:    `neighbours` are the offsets of all points within reach(), in key order.
/// Units:    the scan's; curvature 1/length.
/// Requires: 0 <= degree <= 4, 0 < h <= radius.
/// Errors:   none; a status. Never NaN.
/// Thread:   any number at once.
/// Cost:     five to six passes over the neighbours; allocates nothing.
/// Source:   Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva, "Computing and Rendering Point Set
///           Surfaces", TVCG 9(1), 2003; conditions as in Amenta, Kil, 2004.
Projection project_point(const Offsets& neighbours, const Support& support, const Method& method);

}  // namespace pss
