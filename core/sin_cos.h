#pragma once
// Sine and cosine of one angle at once, the bits of core/math.h for two thirds of the time.

namespace pss {

struct SinCos {
  double sin = 0;
  double cos = 0;
};

/// What sin(x) and cos(x) give.
SinCos sin_cos(double x);

}  // namespace pss
