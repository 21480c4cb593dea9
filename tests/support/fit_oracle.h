#pragma once
// The fit pass of the references: polynomial, curvatures and all that is told of a neighbourhood.

#include <array>

#include "tests/support/mls_oracle.h"

namespace pss::test {

/// The neighbourhood seen from a foot point, in the frame of its plane.
template <class Real>
struct LocalFit {
  int degree = -1;                      ///< the one that was determined; -1 without any weight
  std::array<Real, 15> coefficients{};  ///< of 1, x, y, x^2, x y, y^2, ...
  Real residual = 0;
  Real boundary = 0;
  std::uint32_t neighbours = 0;
  bool second_sheet = false;
};

template <class Real>
std::uint32_t count_within(const OracleCloud<Real>& cloud, const Vector<Real>& q) {
  return static_cast<std::uint32_t>(std::ranges::count_if(
      cloud.points, [&](const Vector<Real>& p) { return (p - q).norm() < cloud.radius; }));
}

/// Whether another sheet lies beside the plane, or the plane between two.
template <class Real>
bool sees_second_sheet(const OracleCloud<Real>& cloud, const OracleFrame<Real>& frame,
                       const Vector<Real>& q) {
  int near = 0;
  int far = 0;
  Real total = 0, square = 0, fourth = 0;
  for (const Vector<Real>& p : cloud.points) {
    const Vector<Real> local = frame.local(p - q);
    const Real w = cloud.weight(p, q).value;
    const Real d_sq = local[2] * local[2];
    total += w;
    square += w * d_sq;
    fourth += w * d_sq * d_sq;
    if ((p - q).norm() < cloud.radius && local[0] * local[0] + local[1] * local[1] < 1)
      ++(d_sq > Real{0.25} ? far : near);
  }
  const bool flat_topped =
      total * fourth < Real{1.5} * square * square && square > Real{0.01} * total;
  return 4 * far > near || flat_topped;
}

/// Solves by QR for as many leading monomials as make up a determined degree.
template <class Real>
void solve_fit(const Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>& design,
               const Eigen::Matrix<Real, Eigen::Dynamic, 1>& heights, int asked,
               LocalFit<Real>& fit) {
  const auto qr = design.householderQr();
  const auto columns = [](int degree) { return (degree + 1) * (degree + 2) / 2; };
  const auto determined = [&](Eigen::Index j) {
    const Real pivot = qr.matrixQR()(j, j);
    return pivot * pivot > Real{1e-6} * design.col(j).squaredNorm();
  };
  int count = 0;
  while (count < columns(asked) && determined(count)) ++count;
  fit.degree = -1;
  while (fit.degree < asked && columns(fit.degree + 1) <= count) ++fit.degree;
  if (fit.degree < 0) return;
  const Eigen::Index used = columns(fit.degree);
  const Eigen::Matrix<Real, Eigen::Dynamic, 1> turned = qr.householderQ().adjoint() * heights;
  const Eigen::Matrix<Real, Eigen::Dynamic, 1> c = qr.matrixQR()
                                                       .topLeftCorner(used, used)
                                                       .template triangularView<Eigen::Upper>()
                                                       .solve(turned.head(used));
  for (Eigen::Index j = 0; j < used; ++j) fit.coefficients[static_cast<std::size_t>(j)] = c[j];
  fit.residual = (design.leftCols(used) * c - heights).norm();
}

/// Fits the heights over the plane through q by weighted least squares.
template <class Real>
LocalFit<Real> fit_about(const OracleCloud<Real>& cloud, const OracleFrame<Real>& frame,
                         const Vector<Real>& q, int degree) {
  const Eigen::Index columns = (degree + 1) * (degree + 2) / 2;
  const auto rows = static_cast<Eigen::Index>(cloud.points.size()) + columns;  // never too few
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> design(rows, columns);
  Eigen::Matrix<Real, Eigen::Dynamic, 1> heights(rows);
  design.setZero();
  heights.setZero();
  Real total = 0;
  Real square = 0;
  Vector<Real> mean = Vector<Real>::Zero();
  Eigen::Index row = 0;
  for (const Vector<Real>& p : cloud.points) {
    const Vector<Real> local = frame.local(p - q);
    const Real w = cloud.weight(p, q).value;
    const Real root = std::sqrt(w);
    Eigen::Index column = 0;
    for (int order = 0; order <= degree; ++order)
      for (int j = 0; j <= order; ++j)
        design(row, column++) =
            root * std::pow(local[0], Real(order - j)) * std::pow(local[1], Real(j));
    heights(row++) = root * local[2];
    total += w;
    square += w * local.squaredNorm();
    mean += w * local;
  }
  LocalFit<Real> fit;
  solve_fit<Real>(design, heights, degree, fit);
  fit.neighbours = count_within(cloud, q);
  if (fit.degree < 0) return fit;
  fit.residual /= std::sqrt(total);
  fit.boundary = square > 0 ? mean.norm() / std::sqrt(total * square) : Real{0};
  fit.second_sheet = sees_second_sheet(cloud, frame, q);
  return fit;
}

template <class Real>
World3 to_world3(const Vector<Real>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Curvatures by the sign of the normal and the direction of the larger one, from the first and
/// second fundamental form.
template <class Real>
void add_curvature(const LocalFit<Real>& fit, const OracleFrame<Real>& frame,
                   const Vector<Real>& normal, Real h, Projection& result) {
  using Matrix2 = Eigen::Matrix<Real, 2, 2>;
  const auto& c = fit.coefficients;
  Matrix2 first;
  Matrix2 second;
  first << 1 + c[1] * c[1], c[1] * c[2], c[1] * c[2], 1 + c[2] * c[2];
  second << 2 * c[3], c[4], c[4], 2 * c[5];
  const Real sign = normal.dot(frame.n) < 0 ? -1 : 1;
  const Matrix2 shape = sign / std::sqrt(1 + c[1] * c[1] + c[2] * c[2]) * first.inverse() * second;
  const Real mean = shape.trace() / 2;
  const Real gaussian = shape.determinant();
  result.mean_curvature = static_cast<double>(mean / h);
  result.gaussian_curvature = static_cast<double>(gaussian / h / h);
  const Real discriminant = mean * mean - gaussian;
  if (!(discriminant > Real{1e-12} * mean * mean)) return;
  // (S - k1)(S - k2) = 0: the columns of S - k2 are directions of k1.
  const Matrix2 others = shape - (mean - std::sqrt(discriminant)) * Matrix2::Identity();
  const Eigen::Matrix<Real, 2, 1> d =
      others.col(0).norm() > others.col(1).norm() ? others.col(0) : others.col(1);
  Vector<Real> tangent = d[0] * (frame.u + c[1] * frame.n) + d[1] * (frame.v + c[2] * frame.n);
  tangent -= tangent.dot(normal) * normal;  // where the normal is not the polynomial's
  result.principal_direction = to_world3(canonical<Real>(tangent.normalized()));
}

/// The result for a point that stays where it is.
inline Projection staying(Status status, std::uint32_t neighbours) {
  Projection result;
  result.status = status;
  result.neighbours = neighbours;
  return result;
}

/// What levin and fast end with: the polynomial over their plane.
template <class Real>
Projection project_onto_polynomial(const OracleCloud<Real>& cloud, const OraclePlane<Real>& plane,
                                   int degree) {
  const Vector<Real> n = plane.status == Status::kOk ? canonical(plane.n) : plane.n;
  const Vector<Real> q = plane.t * plane.n;
  if (plane.status != Status::kOk) return staying(plane.status, count_within(cloud, q));
  const auto frame = OracleFrame<Real>::of(n);
  const LocalFit<Real> fit = fit_about(cloud, frame, q, degree);
  if (fit.degree < 0) return staying(Status::kTooFew, fit.neighbours);
  const auto& c = fit.coefficients;
  if (!(std::abs(c[0]) < Real{0.5})) return staying(Status::kOutOfDomain, fit.neighbours);
  const Vector<Real> normal = canonical<Real>((n - c[1] * frame.u - c[2] * frame.v).normalized());
  Projection result;
  result.status = fit.degree < degree ? Status::kDegreeReduced : Status::kOk;
  result.second_sheet = fit.second_sheet;
  result.neighbours = fit.neighbours;
  result.displacement = to_world3<Real>(cloud.h * (q + c[0] * n));
  result.normal = to_world3(normal);
  if (fit.degree >= 2) add_curvature<Real>(fit, frame, normal, cloud.h, result);
  result.residual = static_cast<double>(fit.residual * cloud.h);
  result.boundary = static_cast<double>(fit.boundary);
  return result;
}

}  // namespace pss::test
