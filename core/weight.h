#pragma once
// The weight of a neighbour: a Gaussian that a smooth taper brings to zero at the radius.

#include "core/math.h"

namespace pss {

/// theta(rho) = exp(-rho^2) S(rho^2), lengths in units of h.
///
/// S is the smoothstep u^3 (10 - 15 u + 6 u^2) of u = (R^2 - rho^2) / (R^2 - (R - 1/2)^2), clamped
/// to [0, 1]: 1 up to R - 1/2, 0 from R on, twice continuously differentiable in rho^2.
class TaperedGaussian {
 public:
  /// The weight, and its derivatives with respect to rho^2.
  struct Value {
    double weight;
    double first;
    double second;
  };

  /// Where exp(-rho^2) is zero whatever the taper does; radii beyond it are cut to it.
  static constexpr double kWidest = 32;

  /// Requires: radius >= 1, in units of h.
  explicit TaperedGaussian(double radius) {
    const double r = radius < kWidest ? radius : kWidest;
    radius_sq_ = r * r;
    per_width_ = 1 / (r - 0.25);  // R^2 - (R - 1/2)^2 = R - 1/4
  }

  double weight(double rho_sq) const {
    const double u = taper_argument(rho_sq);
    return exp(-rho_sq) * smoothstep(u);
  }

  Value with_derivatives(double rho_sq) const {
    const double gauss = exp(-rho_sq);
    const double u = taper_argument(rho_sq);
    const double s = smoothstep(u);
    const double rest = u * (1 - u);
    const double s1 = -per_width_ * (30 * rest * rest);
    const double s2 = per_width_ * per_width_ * (60 * rest * (1 - 2 * u));
    return {gauss * s, gauss * (s1 - s), gauss * (s2 - 2 * s1 + s)};
  }

 private:
  double taper_argument(double rho_sq) const {
    double u = (radius_sq_ - rho_sq) * per_width_;
    u = u < 0 ? 0 : u;
    return u > 1 ? 1 : u;
  }

  static double smoothstep(double u) { return u * u * u * (10 - u * (15 - 6 * u)); }

  double radius_sq_;
  double per_width_;
};

}  // namespace pss
