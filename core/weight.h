#pragma once
// The weights of a neighbour by its squared distance from the foot point.

#include <cmath>
#include <variant>

#include "core/math.h"
#include "core/method.h"

namespace pss {

/// theta(rho) = exp(-rho^2) S(rho^2), lengths in units of h.
///
/// S is the smoothstep u^3 (10 - 15 u + 6 u^2) of u = (R^2 - rho^2) / (R^2 - (R - 1/2)^2), clamped
/// to [0, 1]: 1 up to R - 1/2, 0 from R on, twice continuously differentiable in rho^2.
class TaperedGaussian {
 public:
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

/// (1 - x)^4 (4 x + 1) of x = rho / R, zero from R on; lengths in units of h.
///
/// Source: Wendland, "Piecewise polynomial, positive definite and compactly supported radial
///         functions of minimal degree", 1995.
class WendlandWeight {
 public:
  explicit WendlandWeight(double radius) : per_radius_(1 / radius) {}

  double weight(double rho_sq) const {
    const double x = std::sqrt(rho_sq) * per_radius_;
    const double y = x < 1 ? 1 - x : 0;
    return y * y * y * y * (4 * x + 1);
  }

 private:
  double per_radius_;
};

/// exp(-rho^2 / R^2) without a taper, as PCL weighs; zero only where no candidate is.
class PclWeight {
 public:
  explicit PclWeight(double radius) : per_radius_sq_(1 / (radius * radius)) {}

  double weight(double rho_sq) const {
    constexpr double kNowhere = 1600;  // squared, beyond the widest radius
    return rho_sq < kNowhere ? exp(-rho_sq * per_radius_sq_) : 0;
  }

 private:
  double per_radius_sq_;
};

using AnyWeight = std::variant<TaperedGaussian, WendlandWeight, PclWeight>;

/// Requires: radius >= 1, in units of h.
inline AnyWeight make_weight(WeightKind kind, double radius) {
  const double r = radius < TaperedGaussian::kWidest ? radius : TaperedGaussian::kWidest;
  if (kind == WeightKind::kWendland) return WendlandWeight(r);
  if (kind == WeightKind::kPcl) return PclWeight(r);
  return TaperedGaussian(r);
}

}  // namespace pss
