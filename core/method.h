#pragma once
// Which moving least squares surface: operator, weight, precision and degree.

#include <array>
#include <cstdint>

namespace pss {

/// How a point is carried onto the surface; docs/algorithm.md defines each.
enum class MlsOperator : std::uint8_t {
  kLevin,  ///< reference plane by Newton's method, then a polynomial: a true projection
  kFast,   ///< weighted plane iterated along r + span(n), then the polynomial
  kApss,   ///< algebraic sphere; needs normals
  kRimls,  ///< robust implicit surface; needs normals
};

/// What a neighbour weighs at a distance rho from the foot point.
enum class WeightKind : std::uint8_t {
  kGaussian,  ///< exp(-rho^2 / h^2), tapered to zero at R
  kWendland,  ///< (1 - x)^4 (4 x + 1) of x = rho / R
  kPcl,       ///< exp(-rho^2 / R^2), cut off at R from the query; for comparison only
};

/// The highest degree of a polynomial.
inline constexpr int kMostDegree = 4;

enum class Precision : std::uint8_t {
  kDouble,
  kSingle,  ///< with a redo in double of every point whose numbers ask for it
};

struct Method {
  MlsOperator op = MlsOperator::kLevin;
  WeightKind weight = WeightKind::kGaussian;
  Precision precision = Precision::kDouble;
  int degree = 3;  ///< of the polynomial, 0 to kMostDegree; apss and rimls have none

  bool operator==(const Method&) const = default;
};

inline constexpr std::array kMlsOperators{MlsOperator::kLevin, MlsOperator::kFast,
                                          MlsOperator::kApss, MlsOperator::kRimls};
inline constexpr std::array kWeightKinds{WeightKind::kGaussian, WeightKind::kWendland,
                                         WeightKind::kPcl};

/// "levin", "fast", "apss", "rimls"; "gaussian", "wendland", "pcl"; "double", "single".
const char* name_of(MlsOperator op);
const char* name_of(WeightKind weight);
const char* name_of(Precision precision);

/// Whether the operator looks at normals of the neighbours.
constexpr bool needs_normals(MlsOperator op) {
  return op == MlsOperator::kApss || op == MlsOperator::kRimls;
}

/// The degree of the fit that describes a surface found by apss or rimls, and of the one that gives
/// them normals: a plane's noise, without a plane's bias where the surface bends.
inline constexpr int kNormalsDegree = 2;

/// The projection that gives points the normals that `method` needs, where they have none.
Method normals_method(const Method& method);

}  // namespace pss
