#pragma once
// The operator fast as docs/algorithm.md defines it, slow and separate.

#include "tests/support/fit_oracle.h"

namespace pss::test {

/// The weighted plane, iterated along r + span(n).
template <class Real>
OraclePlane<Real> fast_plane(const OracleCloud<Real>& cloud) {
  OraclePlane<Real> plane = starting_plane(cloud);
  if (plane.status != Status::kOk) return plane;
  for (int pass = 0; pass < 64; ++pass) {
    const PlaneSums<Real> sums = plane_sums<Real>(cloud, plane.t * plane.n);
    const auto ends = [&](Status status) { return OraclePlane<Real>{status, plane.n, plane.t}; };
    if (sums.count < 3) return ends(Status::kTooFew);
    std::optional<Vector<Real>> n = plane_normal(sums);
    if (!n) return ends(Status::kDegenerate);
    if (n->dot(plane.n) < 0) *n = -*n;
    const Real t = bounded_height<Real>(n->dot(sums.centroid));
    const bool still = (*n - plane.n).template lpNorm<Eigen::Infinity>() <= Real{1e-3} &&
                       std::abs(t - plane.t) <= Real{1e-3};
    plane.n = *n;
    plane.t = t;
    if (still) return ends(std::abs(t) < Real{0.5} ? Status::kOk : Status::kOutOfDomain);
  }
  return {Status::kDegenerate, plane.n, plane.t};
}

}  // namespace pss::test
