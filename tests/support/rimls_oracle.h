#pragma once
// The operator rimls as docs/algorithm.md defines it, slow and separate.

#include "tests/support/implicit_oracle.h"

namespace pss::test {

/// A step along the gradient of the robust implicit surface; empty where there is none.
///
/// Source: Oztireli, Guennebaud, Gross, "Feature Preserving Point Set Surfaces based on
///         Non-Linear Kernel Regression", Eurographics 2009.
template <class Real>
std::optional<ImplicitStep<Real>> rimls_step(const OracleCloud<Real>& cloud,
                                             const Vector<Real>& x) {
  constexpr int kRefits = 3;
  const Real sigma_r = Real{0.5};
  const Real sigma_n = Real{0.75};
  Real f = 0;
  Vector<Real> grad = Vector<Real>::Zero();
  for (int refit = 0; refit <= kRefits; ++refit) {
    Real w_sum = 0, f_sum = 0;
    Vector<Real> gw_sum = Vector<Real>::Zero();
    Vector<Real> gwf_sum = Vector<Real>::Zero();
    Vector<Real> n_sum = Vector<Real>::Zero();
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector<Real>& n = cloud.normals[i];
      const Vector<Real> to_x = x - cloud.points[i];
      const Weight<Real> w = cloud.oriented_weight(i, x);
      const Real fi = n.dot(to_x);
      const Real off = (fi - f) / sigma_r;
      const Real turned = (n - grad).norm() / sigma_n;
      const Real a = refit == 0 ? Real{1} : std::exp(-off * off - turned * turned);
      const Vector<Real> gw = 2 * a * w.slope * to_x;
      w_sum += a * w.value;
      f_sum += a * w.value * fi;
      gw_sum += gw;
      gwf_sum += fi * gw;
      n_sum += a * w.value * n;
    }
    if (!(w_sum > 0)) return {};
    f = f_sum / w_sum;
    grad = (gwf_sum - f * gw_sum + n_sum) / w_sum;
  }
  if (!(grad.norm() > 0)) return {};
  ImplicitStep<Real> step;
  step.normal = grad.normalized();
  step.length = -f;
  return step;
}

}  // namespace pss::test
