#pragma once
// Arithmetic on three-vectors.

#include <cmath>

#include "core/lattice.h"

namespace pss {

inline World3 operator+(const World3& a, const World3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline World3 operator-(const World3& a, const World3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline World3 operator-(const World3& a) { return {-a[0], -a[1], -a[2]}; }
inline World3 operator*(double s, const World3& a) { return {s * a[0], s * a[1], s * a[2]}; }

inline double dot(const World3& a, const World3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline World3 normalized(const World3& a) { return 1 / std::sqrt(dot(a, a)) * a; }

}  // namespace pss
