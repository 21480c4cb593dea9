#pragma once
// The local map: the bivariate polynomial that fits the heights over a reference plane.

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/weighted_block.h"

namespace pss {

inline constexpr int kMostDegree = 4;

/// Coefficients of a polynomial of this total degree in two variables.
constexpr std::size_t coefficient_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
}

/// Where monomial x^i y^j stands: 1, x, y, x^2, x y, y^2, x^3, ... so that a polynomial of lower
/// degree is a shorter prefix.
constexpr std::size_t coefficient_index(std::size_t i, std::size_t j) {
  return (i + j) * (i + j + 1) / 2 + j;
}

/// A fitted height field g(x, y) over the plane, all in units of h.
struct LocalMap {
  int degree = -1;  ///< the one that was determined; -1 where no neighbour has a weight
  std::array<double, coefficient_count(kMostDegree)> coefficients{};  ///< zero beyond the degree
  double residual = 0;           ///< weighted rms of g - d, to about 1e-8 of the rms of d
  double boundary = 0;           ///< |weighted mean - q| / weighted rms distance from q
  std::uint32_t neighbours = 0;  ///< nearer to q than the radius
  bool second_sheet = false;     ///< another sheet lies within the neighbourhood

  double coefficient(std::size_t i, std::size_t j) const {
    return coefficients[coefficient_index(i, j)];
  }
};

/// Fits the heights of the neighbours about the point t n of `frame` by weighted least squares.
///
/// The degree falls to the highest one below `degree` that the neighbourhood determines: until
/// each pivot of the normal equations is more than kLeastPivot of its diagonal element.
///
/// Requires: 0 <= degree <= kMostDegree; `radius` in units of h, what counts as a neighbour.
/// Errors:   none; see LocalMap::degree.
/// Cost:     one pass: 9, 21, 38, 60 sums for degrees 1 to 4; allocates nothing.
LocalMap fit_local_map(const Neighbourhood& near, const Frame& frame, double t, double radius,
                       int degree);

/// The share of a monomial that its predecessors must leave unexplained to be determined.
inline constexpr double kLeastPivot = 1e-6;

}  // namespace pss
