#pragma once
// The two conditions on a reference plane, their Jacobian, and Newton's step towards their root.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/weighted_block.h"

namespace pss {

/// Eigenvalues closer than this, of the largest, are equal.
inline constexpr double kEigenvalueTie = 1e-10;

/// All sums of one pass about q = t n: the conditions, their Jacobian, the covariance about q.
///
/// Per neighbour: in-plane coordinates x, y, height d, weight w and its derivatives w', w''.
struct PassSums {
  double w = 0, wx = 0, wy = 0, wd = 0;                   // w {1, x, y, d}
  double xx = 0, xy = 0, yy = 0, xd = 0, yd = 0, dd = 0;  // w {x^2, ...}
  double axx = 0, axy = 0, ayy = 0;                       // w' d {x^2, x y, y^2}
  double bx = 0, by = 0;                                  // w' d^2 {x, y}
  double cubic = 0;                                       // w' d^3
  double ex = 0, ey = 0;                                  // d (w' + d^2 w'') {x, y}
  double curvature = 0;                                   // d^2 (5 w' + 2 d^2 w'')
};

/// Cost: one pass over the neighbours, with the weights' two derivatives.
PassSums sum_about_foot(const Neighbourhood& near, const Frame& frame, double t);

/// A move of the plane: turned by `a` towards u and `b` towards v, slid by `t` along the normal.
struct PlaneStep {
  double a = 0;
  double b = 0;
  double t = 0;

  double size() const { return std::max({std::abs(a), std::abs(b), std::abs(t)}); }
  PlaneStep scaled(double s) const { return {s * a, s * b, s * t}; }
};

/// The conditions F at one place and their Jacobian in (a, b, t), divided by the sum of weights.
struct PlaneConditions {
  std::array<double, 3> f;
  std::array<std::array<double, 3>, 3> jacobian;

  /// Requires: a positive sum of weights.
  PlaneConditions(const PassSums& s, double t);

  double residual() const { return std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]); }
};

/// Whether both conditions are at a minimum of theirs: the normal along the one smallest
/// direction of the covariance about q, the weighted squares convex along the normal.
bool at_minimum(const PassSums& s);

/// Solves J step = -F by elimination with column pivots; nothing where J is singular.
std::optional<PlaneStep> newton_step(const PlaneConditions& c);

}  // namespace pss
