#pragma once
// The operator levin as docs/algorithm.md defines it, slow and separate.

#include "tests/support/fit_oracle.h"

namespace pss::test {

/// The search for the reference plane: Newton's method with the documented safeguards.
///
/// Its Jacobian comes from differences of the conditions, so that it cannot share a mistake with
/// formulas of derivatives.
template <class Real>
class LevinSearch {
 public:
  using Step = Vector<Real>;  ///< turn towards u and v, slide

  explicit LevinSearch(const OracleCloud<Real>& cloud) : cloud_(cloud) {}

  OraclePlane<Real> run() {
    const OraclePlane<Real> start = starting_plane(cloud_);
    if (start.status != Status::kOk) return start;
    at_ = {OracleFrame<Real>::of(start.n), start.t};
    for (int pass = 0; pass < 64; ++pass)
      if (const std::optional<Status> end = advance()) return {*end, at_.frame.n, at_.t};
    return {Status::kDegenerate, at_.frame.n, at_.t};
  }

 private:
  struct Place {
    OracleFrame<Real> frame;
    Real t = 0;
  };

  /// The conditions F (not divided by w) and what tells a minimum.
  struct Conditions {
    Real w = 0;
    Vector<Real> f = Vector<Real>::Zero();
    Matrix<Real> covariance = Matrix<Real>::Zero();  // about q, in the frame
  };

  Conditions conditions(const Place& place) const {
    Conditions c;
    const Vector<Real> q = place.t * place.frame.n;
    for (const Vector<Real>& p : cloud_.points) {
      const Vector<Real> x = place.frame.local(p - q);
      const Real d = x[2];
      const Weight<Real> w = cloud_.weight(p, q);
      c.w += w.value;
      c.f += Vector<Real>(w.value * d * x[0], w.value * d * x[1], d * (w.value + d * d * w.slope));
      c.covariance += w.value * x * x.transpose();
    }
    return c;
  }

  /// The frame carried along, without a turn about n.
  static Place moved(const Place& from, const Step& step) {
    const OracleFrame<Real>& f = from.frame;
    const Vector<Real> n = (f.n + step[0] * f.u + step[1] * f.v).normalized();
    const Vector<Real> u = (f.u - f.u.dot(n) * n).normalized();
    return {{u, n.cross(u), n}, bounded_height<Real>(from.t + step[2])};
  }

  /// dF / d(turn, slide) by central differences.
  Matrix<Real> jacobian() const {
    const Real e = std::cbrt(std::numeric_limits<Real>::epsilon());
    Matrix<Real> j;
    for (Eigen::Index k = 0; k < 3; ++k) {
      Place ahead = moved(at_, e * Step::Unit(k));
      Place behind = moved(at_, -e * Step::Unit(k));
      if (k == 2)
        ahead.t = at_.t + e, behind.t = at_.t - e;  // past the bound where it stands there
      j.col(k) = (conditions(ahead).f - conditions(behind).f) / (2 * e);
    }
    return j;
  }

  static Step shortened(Step step) {
    const Real turn = step.template head<2>().norm();
    if (turn > Real{0.3}) step *= Real{0.3} / turn;
    if (std::abs(step[2]) > Real{0.25}) step *= Real{0.25} / std::abs(step[2]);
    return step;
  }

  static bool at_minimum(const Conditions& c, Real convexity) {
    const Real dd = c.covariance(2, 2);
    const Real least = Real{1e-10} * c.covariance.trace();
    const Real xx = c.covariance(0, 0) - dd;
    const Real yy = c.covariance(1, 1) - dd;
    const Real xy = c.covariance(0, 1);
    return xx > least && xx * yy - xy * xy > least * (xx + yy) && convexity > 0;
  }

  std::optional<Status> advance() {
    const Conditions c = conditions(at_);
    if (!(c.w > 0)) return Status::kTooFew;
    const Vector<Real> f = c.f / c.w;
    const Matrix<Real> j = jacobian() / c.w;
    const bool pushed = std::abs(at_.t) >= Real{0.5} && f[2] * at_.t > 0;
    if (pushed && ++pushes_ >= 4) return Status::kOutOfDomain;
    const bool minimum = at_minimum(c, -j(2, 2));
    if (after_newton_ && (!minimum || (!pushed && f.norm() > last_residual_))) {
      halve();
      return {};
    }
    const Eigen::FullPivLU<Matrix<Real>> lu(j);
    if (!minimum || alternations_ > 0 || !lu.isInvertible()) {
      alternate(c, f, j);
      return {};
    }
    const Step step = shortened(lu.solve(-f));
    halvings_ = 0;
    after_newton_ = true;
    last_residual_ = f.norm();
    last_ = at_;
    last_step_ = step;
    at_ = moved(last_, step);
    const bool converged =
        step.template lpNorm<Eigen::Infinity>() <= Real{1e-8} || last_residual_ <= Real{1e-15};
    if (converged && std::abs(at_.t) < Real{0.5}) return Status::kOk;
    return {};
  }

  void halve() {
    if (++halvings_ > 3) {
      alternations_ = 4 << failures_++;
      after_newton_ = false;
    }
    last_step_ /= 2;
    at_ = moved(last_, last_step_);
  }

  void alternate(const Conditions& c, const Vector<Real>& f, const Matrix<Real>& j) {
    after_newton_ = false;
    halvings_ = 0;
    if (alternations_ > 0) --alternations_;
    const Eigen::SelfAdjointEigenSolver<Matrix<Real>> eigen(c.covariance);
    Vector<Real> e = eigen.eigenvectors().col(0);
    if (e[2] < 0) e = -e;
    const Real along = f[2] + j(2, 0) * e[0] + j(2, 1) * e[1];
    const Real slide = -j(2, 2) > 0 ? std::clamp<Real>(along / -j(2, 2), -0.25, 0.25)
                                    : std::copysign(Real{0.125}, f[2]);
    const OracleFrame<Real>& old = at_.frame;
    const Vector<Real> n = e[0] * old.u + e[1] * old.v + e[2] * old.n;
    at_ = {OracleFrame<Real>::of(n.normalized()), bounded_height<Real>(at_.t + slide)};
  }

  const OracleCloud<Real>& cloud_;
  Place at_, last_;
  Step last_step_ = Step::Zero();
  Real last_residual_ = 0;
  bool after_newton_ = false;
  int halvings_ = 0;
  int alternations_ = 0;
  int failures_ = 0;
  int pushes_ = 0;
};

template <class Real>
OraclePlane<Real> levin_plane(const OracleCloud<Real>& cloud) {
  return LevinSearch<Real>(cloud).run();
}

}  // namespace pss::test
