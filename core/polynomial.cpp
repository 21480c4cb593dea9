#include "core/polynomial.h"

#include <cmath>

namespace pss {
namespace {

constexpr double kThick = 0.01;  // mean square height of what may be two sheets
constexpr double kSplitKurtosis = 1.5;

/// Weighted moments of the neighbours: w x^i y^j up to the order that products of monomials of
/// the degree reach, w d x^i y^j up to the degree, w d^2.
template <int Degree>
struct Moments {
  // Two orders are always there: the boundary value needs them.
  static constexpr std::size_t kOrder = Degree == 0 ? 2 : 2 * Degree;
  static constexpr std::size_t kRows = kOrder + 1;
  static constexpr std::size_t kHeightRows = Degree + 1;

  double area[kRows][kRows] = {};
  double height[kHeightRows][kHeightRows] = {};
  double height_sq = 0;
  double height_fourth = 0;
  std::uint32_t neighbours = 0;
  std::uint32_t near = 0;  // of the neighbours over the unit disc, those at most 1/2 off the plane
  std::uint32_t far = 0;   // and the others

  void add(const WeightedBlock& b, double radius_sq) {
    for (std::size_t n = 0; n < b.count; ++n) {
      add(b.x[n], b.y[n], b.d[n], b.weight[n]);
      count(b.x[n] * b.x[n] + b.y[n] * b.y[n], b.d[n], radius_sq);
    }
  }

 private:
  void count(double across, double d, double radius_sq) {
    const bool neighbour = across + d * d < radius_sq;
    const bool over = neighbour && across < 1;
    const bool off = std::abs(d) > 0.5;
    neighbours += neighbour;
    near += over && !off;
    far += over && off;
  }

  void add(double x, double y, double d, double w) {
    double y_power[kRows];
    y_power[0] = 1;
    for (std::size_t j = 1; j < kRows; ++j) y_power[j] = y_power[j - 1] * y;
    double wx = w;  // w x^i
    for (std::size_t i = 0; i < kRows; ++i) {
      for (std::size_t j = 0; j < kRows - i; ++j) area[i][j] += wx * y_power[j];
      wx *= x;
    }
    double wdx = w * d;
    height_sq += wdx * d;
    height_fourth += wdx * d * (d * d);
    for (std::size_t i = 0; i < kHeightRows; ++i) {
      for (std::size_t j = 0; j < kHeightRows - i; ++j) height[i][j] += wdx * y_power[j];
      wdx *= x;
    }
  }
};

/// Normal equations of at most 15 unknowns, solved as L D L^T.
struct NormalEquations {
  static constexpr std::size_t kMost = coefficient_count(kMostDegree);

  double matrix[kMost][kMost];  // lower triangle; becomes L below the diagonal
  double pivot[kMost];
  double right[kMost];

  /// Factors the leading rows as far as they are determined, and says how many are.
  std::size_t factor(std::size_t size) {
    for (std::size_t j = 0; j < size; ++j) {
      double scaled[kMost];  // row j of L, times D
      double p = matrix[j][j];
      for (std::size_t k = 0; k < j; ++k) {
        double s = matrix[j][k];
        for (std::size_t m = 0; m < k; ++m) s -= scaled[m] * matrix[k][m];
        scaled[k] = s;
        matrix[j][k] = s / pivot[k];
        p -= s * matrix[j][k];
      }
      if (!(p > kLeastPivot * matrix[j][j])) return j;
      pivot[j] = p;
    }
    return size;
  }

  /// Solves the leading `size` equations, in place of the right-hand side; returns how much of
  /// the weighted sum of squared heights they explain.
  double solve(std::size_t size) {
    double explained = 0;
    for (std::size_t j = 0; j < size; ++j) {
      for (std::size_t k = 0; k < j; ++k) right[j] -= matrix[j][k] * right[k];
      explained += right[j] * right[j] / pivot[j];
    }
    for (std::size_t j = size; j-- > 0;) {
      right[j] /= pivot[j];
      for (std::size_t k = j + 1; k < size; ++k) right[j] -= matrix[k][j] * right[k];
    }
    return explained;
  }
};

/// The exponents of monomial number k.
struct Exponents {
  std::size_t x, y;
};

constexpr std::array<Exponents, coefficient_count(kMostDegree)> exponents() {
  std::array<Exponents, coefficient_count(kMostDegree)> result{};
  for (std::size_t total = 0; total <= kMostDegree; ++total)
    for (std::size_t j = 0; j <= total; ++j)
      result[coefficient_index(total - j, j)] = {total - j, j};
  return result;
}

constexpr auto kExponents = exponents();

template <int Degree>
NormalEquations normal_equations(const Moments<Degree>& m) {
  NormalEquations e;
  for (std::size_t r = 0; r < coefficient_count(Degree); ++r) {
    for (std::size_t c = 0; c <= r; ++c)
      e.matrix[r][c] = m.area[kExponents[r].x + kExponents[c].x][kExponents[r].y + kExponents[c].y];
    e.right[r] = m.height[kExponents[r].x][kExponents[r].y];
  }
  return e;
}

template <int Degree>
double boundary_value(const Moments<Degree>& m) {
  const double mean_sq =
      m.area[1][0] * m.area[1][0] + m.area[0][1] * m.area[0][1] + m.height[0][0] * m.height[0][0];
  const double square = m.area[2][0] + m.area[0][2] + m.height_sq;
  return square > 0 ? std::sqrt(mean_sq / (m.area[0][0] * square)) : 0;
}

/// The highest degree whose monomials are all among the first `count`.
int degree_within(std::size_t count) {
  int degree = -1;
  while (degree < kMostDegree && coefficient_count(degree + 1) <= count) ++degree;
  return degree;
}

/// Many points over the foot lie off the plane, or the plane lies between two sheets: heights of
/// one sheet with noise have a kurtosis of 3, of two sheets about 1.
template <int Degree>
bool sees_second_sheet(const Moments<Degree>& m) {
  const double w = m.area[0][0];
  const bool thick = m.height_sq > kThick * w;
  const bool split = w * m.height_fourth < kSplitKurtosis * m.height_sq * m.height_sq;
  return 4 * m.far > m.near || (thick && split);
}

template <int Degree>
LocalMap fit(const Neighbourhood& near, const Frame& frame, double t, double radius) {
  Moments<Degree> moments;
  for_each_block<WeightedBlock>(
      near, frame, t, [&](const WeightedBlock& block) { moments.add(block, radius * radius); });
  NormalEquations equations = normal_equations(moments);
  LocalMap map;
  map.neighbours = moments.neighbours;
  map.second_sheet = sees_second_sheet(moments);
  map.degree = degree_within(equations.factor(coefficient_count(Degree)));
  if (map.degree < 0) return map;
  const std::size_t count = coefficient_count(map.degree);
  const double unexplained = moments.height_sq - equations.solve(count);
  std::copy_n(equations.right, count, map.coefficients.begin());
  map.residual = unexplained > 0 ? std::sqrt(unexplained / moments.area[0][0]) : 0;
  map.boundary = boundary_value(moments);
  return map;
}

}  // namespace

LocalMap fit_local_map(const Neighbourhood& near, const Frame& frame, double t, double radius,
                       int degree) {
  switch (degree) {
    case 0:
      return fit<0>(near, frame, t, radius);
    case 1:
      return fit<1>(near, frame, t, radius);
    case 2:
      return fit<2>(near, frame, t, radius);
    case 3:
      return fit<3>(near, frame, t, radius);
    default:
      return fit<4>(near, frame, t, radius);
  }
}

}  // namespace pss
