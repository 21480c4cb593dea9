#pragma once
// The projection as its definition reads, slow and separate: what the fast one is checked against.

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "core/neighbours.h"
#include "core/projection.h"

namespace pss::test {

/// Everything in extended precision, with the library's exp and Eigen's solvers.
class LevinOracle {
 public:
  using Real = long double;
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Matrix = Eigen::Matrix<Real, 3, 3>;

  struct Result {
    bool converged = false;
    Vector displacement;
    Vector normal;            // of the polynomial, either sign
    Real mean_curvature = 0;  // with respect to that normal
    Real gaussian_curvature = 0;
    Real residual = 0;
    Real boundary = 0;
  };

  LevinOracle(const Offsets& offsets, const Support& support) : h_(support.h), r_(support.radius) {
    for (std::size_t i = 0; i < offsets.size(); ++i)
      points_.emplace_back(offsets.x[i], offsets.y[i], offsets.z[i]);
  }

  Result project(int degree) const {
    Vector n;
    Real t = 0;
    start(n, t);
    Result result;
    for (int i = 0; i < 5000 && !result.converged; ++i) {
      const Vector turned = smallest(covariance(t * n, t * n), n);
      const Real slide = 0.5L * residual_along(turned, t);
      result.converged = (turned - n).norm() < 1e-17L && std::abs(slide) < 1e-17L * h_;
      n = turned;
      t += slide;
    }
    fit(n, t, degree, result);
    return result;
  }

 private:
  Real taper(Real rho_sq) const {
    const Real inner = r_ - h_ / 2;
    Real u = (r_ * r_ - rho_sq) / (r_ * r_ - inner * inner);
    u = std::min(std::max(u, Real{0}), Real{1});
    return u * u * u * (10 - 15 * u + 6 * u * u);
  }

  Real weight(Real rho_sq) const { return std::exp(-rho_sq / (h_ * h_)) * taper(rho_sq); }

  /// dw / d(rho^2) by a central difference: independent of the formula under test.
  Real weight_slope(Real rho_sq) const {
    const Real e = 1e-6L * h_ * h_;
    return (8 * (weight(rho_sq + e) - weight(rho_sq - e)) -
            (weight(rho_sq + 2 * e) - weight(rho_sq - 2 * e))) /
           (12 * e);
  }

  /// Sum of w (p - centre)(p - centre)^T, weights frozen at q.
  Matrix covariance(const Vector& q, const Vector& centre) const {
    Matrix c = Matrix::Zero();
    for (const Vector& p : points_)
      c += weight((p - q).squaredNorm()) * (p - centre) * (p - centre).transpose();
    return c;
  }

  /// The eigenvector of the smallest eigenvalue, on the side of `like`.
  static Vector smallest(const Matrix& c, const Vector& like) {
    const Vector n = Eigen::SelfAdjointEigenSolver<Matrix>(c).eigenvectors().col(0);
    return n.dot(like) < 0 ? Vector(-n) : n;
  }

  void start(Vector& n, Real& t) const {
    Real total = 0;
    Vector mean = Vector::Zero();
    for (const Vector& p : points_) {
      total += weight(p.squaredNorm());
      mean += weight(p.squaredNorm()) * p;
    }
    mean /= total;
    n = smallest(covariance(Vector::Zero(), mean), Vector::UnitZ());
    t = std::min(std::max(n.dot(mean), -h_ / 2), h_ / 2);
  }

  /// Sum of d (w + d^2 w'), divided by the sum of w: a length.
  Real residual_along(const Vector& n, Real t) const {
    Real sum = 0;
    Real total = 0;
    for (const Vector& p : points_) {
      const Real rho_sq = (p - t * n).squaredNorm();
      const Real d = n.dot(p) - t;
      sum += d * (weight(rho_sq) + d * d * weight_slope(rho_sq));
      total += weight(rho_sq);
    }
    return sum / total;
  }

  void fit(const Vector& n, Real t, int degree, Result& result) const {
    const Vector u = n.unitOrthogonal();
    const Vector v = n.cross(u);
    const auto rows = static_cast<Eigen::Index>(points_.size());
    Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> design(rows,
                                                               (degree + 1) * (degree + 2) / 2);
    Eigen::Matrix<Real, Eigen::Dynamic, 1> heights(rows);
    Real total = 0;
    Real square = 0;
    Vector mean = Vector::Zero();
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Vector p = points_[static_cast<std::size_t>(i)] - t * n;
      const Real w = weight(p.squaredNorm());
      Eigen::Index column = 0;
      for (int order = 0; order <= degree; ++order)
        for (int j = 0; j <= order; ++j)
          design(i, column++) = std::sqrt(w) * std::pow(u.dot(p) / h_, Real(order - j)) *
                                std::pow(v.dot(p) / h_, Real(j));
      heights(i) = std::sqrt(w) * n.dot(p);
      total += w;
      square += w * p.squaredNorm();
      mean += w * p;
    }
    const auto c = design.householderQr().solve(heights).eval();
    result.residual = std::sqrt((design * c - heights).squaredNorm() / total);
    result.boundary = (mean / total).norm() / std::sqrt(square / total);
    result.displacement = (t + c(0)) * n;
    result.normal = n;
    if (degree >= 1) result.normal = (n - c(1) / h_ * u - c(2) / h_ * v).normalized();
    if (degree >= 2) curvatures(c(1) / h_, c(2) / h_, 2 * c(3), c(4), 2 * c(5), result);
  }

  void curvatures(Real gu, Real gv, Real guu, Real guv, Real gvv, Result& result) const {
    // The shape operator as a matrix: second fundamental form over the first.
    Eigen::Matrix<Real, 2, 2> first;
    Eigen::Matrix<Real, 2, 2> second;
    first << 1 + gu * gu, gu * gv, gu * gv, 1 + gv * gv;
    second << guu, guv, guv, gvv;
    second /= h_ * h_ * std::sqrt(1 + gu * gu + gv * gv);
    const Eigen::Matrix<Real, 2, 2> shape = first.inverse() * second;
    result.mean_curvature = shape.trace() / 2;
    result.gaussian_curvature = shape.determinant();
  }

  Real h_, r_;
  std::vector<Vector> points_;
};

}  // namespace pss::test
