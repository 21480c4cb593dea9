#pragma once
// What the slow, readable references of all operators share: weights, planes, polynomial, outputs.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/projection.h"

namespace pss::test {

template <class Real>
using Vector = Eigen::Matrix<Real, 3, 1>;
template <class Real>
using Matrix = Eigen::Matrix<Real, 3, 3>;

/// A weight and its derivative with respect to rho^2.
template <class Real>
struct Weight {
  Real value = 0;
  Real slope = 0;
};

/// The weight at a squared distance, lengths in units of h.
template <class Real>
Weight<Real> weight_of(WeightKind kind, Real radius, Real rho_sq) {
  if (kind == WeightKind::kPcl) {  // cut off about the query, not here
    const Real w = std::exp(-rho_sq / (radius * radius));
    return {w, -w / (radius * radius)};
  }
  if (!(rho_sq < radius * radius)) return {};
  if (kind == WeightKind::kWendland) {
    const Real x = std::sqrt(rho_sq) / radius;
    const Real left = 1 - x;
    return {left * left * left * left * (4 * x + 1), -10 * left * left * left / (radius * radius)};
  }
  const Real inner = radius - Real{0.5};
  const Real width = radius * radius - inner * inner;
  const Real u = std::clamp<Real>((radius * radius - rho_sq) / width, 0, 1);
  const Real taper = u * u * u * (10 - 15 * u + 6 * u * u);
  const Real gauss = rho_sq > 707 ? Real{0} : std::exp(-rho_sq);
  return {gauss * taper, gauss * (-30 * u * u * (1 - u) * (1 - u) / width - taper)};
}

/// One query's neighbours in units of h, the query at the origin.
template <class Real>
struct OracleCloud {
  std::vector<Vector<Real>> points;
  std::vector<Vector<Real>> normals;  ///< empty, or one a point; zero where it has none
  bool oriented = false;
  WeightKind kind = WeightKind::kGaussian;
  Real h = 1;       ///< in the scan's units
  Real radius = 3;  ///< in units of h

  Weight<Real> weight(const Vector<Real>& p, const Vector<Real>& q) const {
    return weight_of<Real>(kind, radius, (p - q).squaredNorm());
  }

  /// The weight of point i where normals count: none without a normal.
  Weight<Real> oriented_weight(std::size_t i, const Vector<Real>& q) const {
    return normals[i].isZero(0) ? Weight<Real>{} : weight(points[i], q);
  }
};

/// Normals that the operators may use, one a point; none for levin and fast.
struct OracleNormals {
  std::span<const World3> values;
  bool oriented = false;
};

/// The points that the query may see, in units of h.
template <class Real>
OracleCloud<Real> oracle_cloud(std::span<const World3> offsets, const Support& support,
                               WeightKind kind, const OracleNormals& normals = {}) {
  OracleCloud<Real> cloud;
  cloud.oriented = normals.oriented;
  cloud.kind = kind;
  cloud.h = support.h;
  cloud.radius = Real{support.radius} / cloud.h;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const auto& [x, y, z] = offsets[i];
    const Vector<Real> p = Vector<Real>(x, y, z);
    if (!(p.norm() < Real{reach(kind, support)})) continue;
    if (!normals.values.empty()) {
      const auto& [nx, ny, nz] = normals.values[i];
      cloud.normals.push_back(Vector<Real>(nx, ny, nz));
    }
    cloud.points.push_back(p / cloud.h);
  }
  return cloud;
}

template <class Real>
bool has_canonical_sign(const Vector<Real>& n) {
  Eigen::Index largest = 0;
  for (Eigen::Index a = 1; a < 3; ++a)
    if (std::abs(n[a]) > std::abs(n[largest])) largest = a;
  return n[largest] > 0;
}

template <class Real>
Vector<Real> canonical(const Vector<Real>& n) {
  return has_canonical_sign(n) ? n : Vector<Real>(-n);
}

/// An orthonormal frame; its in-plane axes decide which monomial a fit finds undetermined.
template <class Real>
struct OracleFrame {
  Vector<Real> u, v, n;

  /// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
  static OracleFrame of(const Vector<Real>& n) {
    const Real sign = std::copysign(Real{1}, n[2]);
    const Real a = -1 / (sign + n[2]);
    const Real b = n[0] * n[1] * a;
    return {{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
            {b, sign + n[1] * n[1] * a, -n[1]},
            n};
  }

  Vector<Real> local(const Vector<Real>& p) const { return {u.dot(p), v.dot(p), n.dot(p)}; }
};

/// Sums of one pass with weights about q.
template <class Real>
struct PlaneSums {
  std::size_t count = 0;  ///< of neighbours with a weight
  Real w = 0;
  Vector<Real> centroid = Vector<Real>::Zero();
  Matrix<Real> covariance = Matrix<Real>::Zero();  ///< about the centroid, over w
};

template <class Real>
PlaneSums<Real> plane_sums(const OracleCloud<Real>& cloud, const Vector<Real>& q) {
  PlaneSums<Real> s;
  for (const Vector<Real>& p : cloud.points) {
    const Real w = cloud.weight(p, q).value;
    s.count += w > 0;
    s.w += w;
    s.centroid += w * p;
  }
  if (!(s.w > 0)) return s;
  s.centroid /= s.w;
  for (const Vector<Real>& p : cloud.points) {
    const Vector<Real> d = p - s.centroid;
    s.covariance += cloud.weight(p, q).value / s.w * d * d.transpose();
  }
  return s;
}

/// The direction of the smallest eigenvalue; empty where the points do not determine one.
template <class Real>
std::optional<Vector<Real>> plane_normal(const PlaneSums<Real>& sums) {
  const Eigen::SelfAdjointEigenSolver<Matrix<Real>> eigen(sums.covariance);
  const Vector<Real> e = eigen.eigenvalues();
  const Real least = Real{1e-10} * e[2];
  if (!(e[2] > Real{1e-24} && e[1] > least && e[1] - e[0] > least)) return {};
  return canonical<Real>(eigen.eigenvectors().col(0));
}

/// A plane through t n, or why there is none.
template <class Real>
struct OraclePlane {
  Status status = Status::kTooFew;
  Vector<Real> n = Vector<Real>::Zero();
  Real t = 0;
};

template <class Real>
Real bounded_height(Real t) {
  return std::clamp<Real>(t, Real{-0.5}, Real{0.5});
}

/// Where levin and fast start: the plane of the weights about the query.
template <class Real>
OraclePlane<Real> starting_plane(const OracleCloud<Real>& cloud) {
  const PlaneSums<Real> sums = plane_sums<Real>(cloud, Vector<Real>::Zero());
  if (sums.count < 3) return {};
  const std::optional<Vector<Real>> n = plane_normal(sums);
  if (!n) return {Status::kDegenerate};
  return {Status::kOk, *n, bounded_height<Real>(n->dot(sums.centroid))};
}

}  // namespace pss::test
