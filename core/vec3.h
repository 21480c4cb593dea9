#pragma once
// Arithmetic on three-vectors, and orthonormal frames.

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

/// A right-handed orthonormal frame.
struct Frame {
  World3 u{1, 0, 0};
  World3 v{0, 1, 0};
  World3 n{0, 0, 1};
};

/// The frame whose in-plane axes are a pure function of the unit vector `n`.
///
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
inline Frame frame_of(const World3& n) {
  const double sign = std::copysign(1.0, n[2]);
  const double a = -1 / (sign + n[2]);
  const double b = n[0] * n[1] * a;
  return {
      {1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, {b, sign + n[1] * n[1] * a, -n[1]}, n};
}

/// Whether `n` points the canonical way: its component of largest magnitude, the first of equals,
/// is positive.
inline bool is_canonical(const World3& n) {
  std::size_t largest = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(n[a]) > std::abs(n[largest])) largest = a;
  return n[largest] > 0;
}

}  // namespace pss
