#pragma once
// What weighted least squares gives on dense even samples, from integrals over the weight.

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "tests/support/mls_oracle.h"

namespace pss::test {

/// The asymptotics of a polynomial fit of a degree with a weight, lengths in units of h.
///
/// At the centre only the powers u^j of u = x^2 + y^2 count: the fit there is a weighted mean with
/// the weight w(u) q(u), q the polynomial with <q> = 1 and <q u^j> = 0.
class ClosedForms {
 public:
  ClosedForms(WeightKind kind, double radius, int degree)
      : kind_(kind), radius_(radius), terms_(degree / 2 + 1) {
    const Eigen::Index n = terms_;
    Eigen::MatrixXd gram(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) gram(i, j) = mean(static_cast<double>(2 * (i + j)));
    inverse_ = gram.inverse();
  }

  /// The signed distance of the projection from a sphere, negative inside.
  double sphere_bias(double rho) const {
    // z = -u/(2 rho) - u^2/(8 rho^3) - u^3/(16 rho^5): the first power that the fit has not.
    const double series[] = {0, 1 / (2 * rho), 1 / (8 * std::pow(rho, 3)),
                             1 / (16 * std::pow(rho, 5))};
    return -series[terms_] * coefficients_of(terms_)[0];
  }

  /// The mean curvature over that of the sphere, for degrees 2 and 3.
  double sphere_curvature_ratio(double rho) const {
    return 1 + coefficients_of(2)[1] / (4 * rho * rho);
  }

  /// C in: noise of deviation sigma leaves heights of deviation C sigma s / h.
  double noise_constant() const {
    const Eigen::VectorXd q = inverse_.col(0);
    const double square = integral([&](double r) {
      double value = 0;
      for (Eigen::Index j = 0; j < terms_; ++j)
        value += q[j] * std::pow(r, static_cast<double>(2 * j));
      return weight(r) * value * value * weight(r) * r;
    });
    const double total = integral([&](double r) { return weight(r) * r; });
    return std::sqrt(square / (2 * std::numbers::pi)) / total;
  }

  /// |weighted mean - q| / weighted rms distance on a straight edge.
  double edge_boundary() const { return 2 / std::numbers::pi * mean(1) / std::sqrt(mean(2)); }

  /// The weighted mean of a power of the distance.
  double mean(double power) const {
    return integral([&](double r) { return weight(r) * std::pow(r, power) * r; }) /
           integral([&](double r) { return weight(r) * r; });
  }

 private:
  double weight(double r) const { return weight_of<double>(kind_, radius_, r * r).value; }

  /// The coefficients of 1, u, ... in the fit of u^power.
  Eigen::VectorXd coefficients_of(int power) const {
    Eigen::VectorXd right(terms_);
    for (Eigen::Index j = 0; j < terms_; ++j) right[j] = mean(2 * (power + static_cast<double>(j)));
    return inverse_ * right;
  }

  /// From 0 to the radius, by Simpson's rule.
  template <class Function>
  double integral(const Function& f) const {
    constexpr int kIntervals = 4000;
    const double step = radius_ / kIntervals;
    double sum = f(0) + f(radius_ * (1 - 1e-15));
    for (int i = 1; i < kIntervals; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(step * i);
    return sum * step / 3;
  }

  WeightKind kind_;
  double radius_;
  int terms_;
  Eigen::MatrixXd inverse_;
};

}  // namespace pss::test
