#pragma once
// What a weighted polynomial fit makes of noise: its equivalent kernel on dense, even samples.

#include <array>

#include "core/method.h"

namespace pss {

/// The fitted height at the foot is a weighted mean of the samples' heights; this is its weight.
///
/// By symmetry the weight is a polynomial of the squared distance times theta. All lengths are in
/// units of h unless said otherwise; noise is independent, of unit variance, along the normal.
///
/// Source: local polynomial regression as a linear smoother: Fan, Gijbels, "Local Polynomial
///         Modelling and Its Applications", 1996, sections 3.2 and 3.3.
class FitKernel {
 public:
  /// Of the fit of this degree with a weight that is zero at `radius`.
  ///
  /// Requires: 0 <= degree <= 4, radius >= 1.
  FitKernel(WeightKind weight, int degree, double radius);

  /// The variance of the fitted height with one sample an area h^2.
  double noise_sq() const { return noise_sq_; }

  /// The mean square difference of the heights fitted at the widths `a` and `b` with one sample a
  /// unit of area; `a` and `b` in units of its root.
  double difference_sq(double a, double b) const;

  /// The share of the weighted mean square residual that the fit takes away, at one sample an h^2.
  double absorbed() const { return absorbed_; }

  /// (sum w)^2 / sum w^2 at one sample an h^2: how many even weights would count alike.
  double samples() const { return samples_; }

 private:
  /// The kernel over the weight.
  double shape(double rho_sq) const {
    return factors_[0] + rho_sq * (factors_[1] + rho_sq * factors_[2]);
  }

  WeightKind weight_;
  double radius_;
  std::array<double, 3> factors_{};  ///< of 1, rho^2, rho^4
  double noise_sq_ = 0;
  double absorbed_ = 0;
  double samples_ = 0;
};

}  // namespace pss
