#include "core/fit_kernel.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numbers>
#include <variant>

#include "core/weight.h"

namespace pss {
namespace {

/// The weight, zero from the radius on.
class Weight {
 public:
  Weight(WeightKind kind, double radius)
      : weight_(make_weight(kind, radius)), end_(radius * radius) {}

  double end() const { return end_; }
  double operator()(double rho_sq) const {
    if (rho_sq >= end_) return 0;
    return std::visit([rho_sq](const auto& weight) { return weight.weight(rho_sq); }, weight_);
  }

 private:
  AnyWeight weight_;
  double end_;
};

constexpr std::size_t kSteps = 2000;
constexpr std::size_t kMost = 3;  ///< radial powers of a degree

/// The integral over the disc rho^2 < `end` of a function of rho^2, by the midpoint rule.
template <class Function>
double over_disc(double end, Function f) {
  const double step = end / kSteps;
  double sum = 0;
  for (std::size_t i = 0; i < kSteps; ++i) sum += f((static_cast<double>(i) + 0.5) * step);
  return std::numbers::pi * step * sum;
}

double power(double x, std::size_t n) {
  double result = 1;
  for (; n > 0; --n) result *= x;
  return result;
}

using Matrix = std::array<std::array<double, kMost>, kMost>;

/// The moments of rho^2 from order `first` on, under a weight.
template <class Function>
Matrix moments(Function weight, double end, std::size_t first, std::size_t size) {
  std::array<double, 2 * kMost - 1> values{};
  for (std::size_t k = 0; k + 1 < 2 * size; ++k)
    values[k] = over_disc(end, [&](double t) { return power(t, first + k) * weight(t); });
  Matrix matrix{};
  for (std::size_t r = 0; r < size; ++r)
    for (std::size_t c = 0; c < size; ++c) matrix[r][c] = values[r + c];
  return matrix;
}

/// The solution of `matrix` x = `right`, by elimination: moment matrices are positive definite.
std::array<double, kMost> solve(Matrix matrix, std::array<double, kMost> right, std::size_t size) {
  for (std::size_t p = 0; p < size; ++p)
    for (std::size_t r = p + 1; r < size; ++r) {
      const double factor = matrix[r][p] / matrix[p][p];
      for (std::size_t c = p; c < size; ++c) matrix[r][c] -= factor * matrix[p][c];
      right[r] -= factor * right[p];
    }
  for (std::size_t r = size; r-- > 0;) {
    for (std::size_t c = r + 1; c < size; ++c) right[r] -= matrix[r][c] * right[c];
    right[r] /= matrix[r][r];
  }
  return right;
}

/// The trace of the inverse of `a` times `b`.
double trace_of_quotient(const Matrix& a, const Matrix& b, std::size_t size) {
  double trace = 0;
  for (std::size_t c = 0; c < size; ++c) {
    std::array<double, kMost> column{};
    for (std::size_t r = 0; r < size; ++r) column[r] = b[r][c];
    trace += solve(a, column, size)[c];
  }
  return trace;
}

}  // namespace

FitKernel::FitKernel(WeightKind kind, int degree, double radius) : weight_(kind), radius_(radius) {
  assert(0 <= degree && degree <= 4 && radius >= 1);
  const Weight weight(kind, radius);
  const double end = weight.end();
  const auto order = static_cast<std::size_t>(degree);
  const auto squared = [&](double t) { return weight(t) * weight(t); };
  factors_ = solve(moments(weight, end, 0, order / 2 + 1), {1, 0, 0}, order / 2 + 1);
  noise_sq_ = over_disc(end, [&](double t) { return shape(t) * shape(t) * squared(t); });

  const double sum = over_disc(end, weight);
  samples_ = sum * sum / over_disc(end, squared);
  // Monomials of one angular order: rho^l, rho^(l+2), ... with cosine and sine for l > 0.
  for (std::size_t l = 0; l <= order; ++l) {
    const std::size_t size = (order - l) / 2 + 1;
    const double share =
        trace_of_quotient(moments(weight, end, l, size), moments(squared, end, l, size), size);
    absorbed_ += (l > 0 ? 2 : 1) * share / sum;
  }
}

double FitKernel::difference_sq(double a, double b) const {
  const Weight weight(weight_, radius_);
  const auto at = [&](double t) { return shape(t) * weight(t); };
  const double wider = std::max(a, b) * radius_;
  return over_disc(wider * wider, [&](double t) {
    const double difference = at(t / (a * a)) / (a * a) - at(t / (b * b)) / (b * b);
    return difference * difference;
  });
}

}  // namespace pss
