#pragma once
// The operator apss as docs/algorithm.md defines it, slow and separate.

#include "tests/support/implicit_oracle.h"

namespace pss::test {

/// A step towards the algebraic sphere of the weights about x; empty where there is none.
///
/// Source: Guennebaud, Gross, "Algebraic Point Set Surfaces", SIGGRAPH 2007.
template <class Real>
std::optional<ImplicitStep<Real>> apss_step(const OracleCloud<Real>& cloud, const Vector<Real>& x) {
  Real w_sum = 0, pn = 0, pp = 0;
  Vector<Real> p_sum = Vector<Real>::Zero();
  Vector<Real> n_sum = Vector<Real>::Zero();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vector<Real> p = cloud.points[i] - x;
    const Vector<Real>& n = cloud.normals[i];
    const Real w = cloud.oriented_weight(i, x).value;
    w_sum += w;
    p_sum += w * p;
    n_sum += w * n;
    pn += w * p.dot(n);
    pp += w * p.squaredNorm();
  }
  const Real spread = pp - p_sum.squaredNorm() / w_sum;
  const auto count = static_cast<Real>(cloud.points.size());
  const Real least = 4 * std::numeric_limits<Real>::epsilon() * count * pp;
  const Real uq = spread > least ? (pn - p_sum.dot(n_sum) / w_sum) / spread / 2 : Real{0};
  const Vector<Real> ul = (n_sum - 2 * uq * p_sum) / w_sum;
  const Real uc = -(ul.dot(p_sum) + uq * pp) / w_sum;
  const Real gradient = ul.norm();
  const Real discriminant = gradient * gradient - 4 * uc * uq;
  if (!(gradient > 0) || !(discriminant > 0)) return {};
  const Real at_surface = std::sqrt(discriminant);
  ImplicitStep<Real> step;
  step.normal = ul / gradient;
  step.length = -2 * uc / (gradient + at_surface);
  step.mean_curvature = -2 * uq / at_surface;
  return step;
}

}  // namespace pss::test
