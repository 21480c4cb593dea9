#pragma once
// What the references of apss and rimls share: steps along a gradient until they are short.

#include <functional>
#include <limits>

#include "tests/support/fit_oracle.h"

namespace pss::test {

/// A move of `length` along `normal` that brings a place onto the surface its weights see.
template <class Real>
struct ImplicitStep {
  Vector<Real> normal = Vector<Real>::Zero();
  Real length = 0;
  std::optional<Real> mean_curvature;  ///< where the operator itself determines it
};

/// Turns normals of unknown side to agree with the neighbourhood's main direction.
template <class Real>
void orient(OracleCloud<Real>& cloud) {
  Matrix<Real> spread = Matrix<Real>::Zero();
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    spread += cloud.oriented_weight(i, Vector<Real>::Zero()).value * cloud.normals[i] *
              cloud.normals[i].transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix<Real>> eigen(spread);
  const Vector<Real> main = canonical<Real>(eigen.eigenvectors().col(2));
  for (Vector<Real>& n : cloud.normals)
    if (n.dot(main) < 0) n = -n;
}

template <class Real>
std::size_t count_weighted(const OracleCloud<Real>& cloud, const Vector<Real>& x) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    count += cloud.oriented_weight(i, x).value > 0;
  return count;
}

/// The result at the final place: its fit pass, the normal's sign, the curvatures.
template <class Real>
Projection describe_implicit(const OracleCloud<Real>& cloud, const Vector<Real>& x,
                             const ImplicitStep<Real>& last) {
  const Vector<Real> normal = cloud.oriented ? last.normal : canonical(last.normal);
  const auto frame = OracleFrame<Real>::of(normal);
  const LocalFit<Real> fit = fit_about(cloud, frame, x, 2);
  Projection result;
  result.status = Status::kOk;
  result.second_sheet = fit.second_sheet;
  result.neighbours = fit.neighbours;
  result.displacement = to_world3<Real>(cloud.h * x);
  result.normal = to_world3(normal);
  result.residual = static_cast<double>(fit.residual * cloud.h);
  result.boundary = static_cast<double>(fit.boundary);
  if (last.mean_curvature) {
    const Real sign = normal.dot(last.normal) < 0 ? -1 : 1;
    result.mean_curvature = static_cast<double>(sign * *last.mean_curvature / cloud.h);
    result.gaussian_curvature = result.mean_curvature * result.mean_curvature;
  } else if (fit.degree >= 2) {
    add_curvature<Real>(fit, frame, normal, cloud.h, result);
  }
  return result;
}

/// Follows `step_at` from the query until a step is at most `tolerance`, in units of h.
template <class Real>
Projection project_implicit(OracleCloud<Real> cloud, Real tolerance,
                            const std::function<std::optional<ImplicitStep<Real>>(
                                const OracleCloud<Real>&, const Vector<Real>&)>& step_at) {
  Vector<Real> x = Vector<Real>::Zero();
  if (count_weighted(cloud, x) >= 3 && !cloud.oriented) orient(cloud);
  for (int i = 0; i < 32; ++i) {
    const std::uint32_t neighbours = count_within(cloud, x);
    if (count_weighted(cloud, x) < 3) return staying(Status::kTooFew, neighbours);
    const std::optional<ImplicitStep<Real>> step = step_at(cloud, x);
    if (!step) return staying(Status::kDegenerate, neighbours);
    const Vector<Real> next = x + step->length * step->normal;
    if (!(next.norm() < Real{0.5})) return staying(Status::kOutOfDomain, neighbours);
    x = next;
    if (std::abs(step->length) <= tolerance) return describe_implicit(cloud, x, *step);
  }
  return staying(Status::kDegenerate, count_within(cloud, x));
}

}  // namespace pss::test
