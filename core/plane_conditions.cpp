#include "core/plane_conditions.h"

#include <utility>

namespace pss {

PassSums sum_about_foot(const Neighbourhood& near, const Frame& frame, double t) {
  PassSums s;
  for_each_block<DerivativeBlock>(near, frame, t, [&](const DerivativeBlock& block) {
    PassSums r = s;  // in registers as far as they go
    for (std::size_t i = 0; i < block.count; ++i) {
      const double x = block.x[i];
      const double y = block.y[i];
      const double d = block.d[i];
      const double w = block.weight[i];
      const double w1 = block.first[i];
      const double w2 = block.second[i];
      const double wx = w * x;
      const double wy = w * y;
      const double d2 = d * d;
      const double a = w1 * d;
      const double ax = a * x;
      const double ay = a * y;
      const double e = d * (w1 + d2 * w2);
      r.w += w;
      r.wx += wx;
      r.wy += wy;
      r.wd += w * d;
      r.xx += wx * x;
      r.xy += wx * y;
      r.yy += wy * y;
      r.xd += wx * d;
      r.yd += wy * d;
      r.dd += w * d2;
      r.axx += ax * x;
      r.axy += ax * y;
      r.ayy += ay * y;
      r.bx += ax * d;
      r.by += ay * d;
      r.cubic += a * d2;
      r.ex += e * x;
      r.ey += e * y;
      r.curvature += d2 * (5 * w1 + 2 * d2 * w2);
    }
    s = r;
  });
  return s;
}

PlaneConditions::PlaneConditions(const PassSums& s, double t) {
  const double per_w = 1 / s.w;
  f = {s.xd * per_w, s.yd * per_w, (s.wd + s.cubic) * per_w};
  const double turn = s.dd + t * s.wd;
  jacobian[0] = {(s.xx - turn - 2 * t * s.axx) * per_w, (s.xy - 2 * t * s.axy) * per_w,
                 -(s.wx + 2 * s.bx) * per_w};
  jacobian[1] = {jacobian[0][1], (s.yy - turn - 2 * t * s.ayy) * per_w, -(s.wy + 2 * s.by) * per_w};
  jacobian[2] = {(s.wx + 3 * s.bx - 2 * t * s.ex) * per_w, (s.wy + 3 * s.by - 2 * t * s.ey) * per_w,
                 -(s.w + s.curvature) * per_w};
}

bool at_minimum(const PassSums& s) {
  const double xx = s.xx - s.dd;
  const double yy = s.yy - s.dd;
  const double least = kEigenvalueTie * (s.xx + s.yy + s.dd);
  return xx > least && xx * yy - s.xy * s.xy > least * (xx + yy) && s.w + s.curvature > 0;
}

std::optional<PlaneStep> newton_step(const PlaneConditions& c) {
  std::array<std::array<double, 4>, 3> m;
  for (std::size_t i = 0; i < 3; ++i)
    m[i] = {c.jacobian[i][0], c.jacobian[i][1], c.jacobian[i][2], -c.f[i]};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 3; ++i)
      if (std::abs(m[i][k]) > std::abs(m[pivot][k])) pivot = i;
    std::swap(m[k], m[pivot]);
    if (!(std::abs(m[k][k]) > 1e-30)) return std::nullopt;
    for (std::size_t i = k + 1; i < 3; ++i) {
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < 4; ++j) m[i][j] -= factor * m[k][j];
    }
  }
  PlaneStep step;
  step.t = m[2][3] / m[2][2];
  step.b = (m[1][3] - m[1][2] * step.t) / m[1][1];
  step.a = (m[0][3] - m[0][1] * step.b - m[0][2] * step.t) / m[0][0];
  return step;
}

}  // namespace pss
