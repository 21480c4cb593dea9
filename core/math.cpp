#include "core/math.h"

#include <cmath>

#include "core/sin_cos.h"

namespace pss {
namespace {

/// An angle reduced to [-pi/4, pi/4], as a double and what it lacks, and the quarter it was in.
struct Reduced {
  double high;
  double low;
  unsigned quarter;
};

/// Subtracts multiples of pi/2, which is held in parts of 33, 33 and 53 bits: the products with
/// the multiple are exact while it stays below 2^20.
Reduced reduce(double x) {
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  constexpr double kPart1 = 0x1.921fb544p+0;
  constexpr double kPart2 = 0x1.0b4611a6p-34;
  constexpr double kPart3 = 0x1.3198a2e037073p-69;
  const double shifted = x * kTwoOverPi + kRoundingShift;
  const double k = shifted - kRoundingShift;
  const double a = x - k * kPart1;  // exact: both within a factor of two, or k is 0
  const double b = k * kPart2;
  const double c = a - b;
  const double lost = (a - c) - b;
  const double d = k * kPart3 - lost;
  const double high = c - d;
  return {high, (c - high) - d, static_cast<unsigned>(std::bit_cast<std::uint64_t>(shifted) & 3)};
}

/// Taylor series to degree 17; the next term is below 2^-63.
double sin_kernel(double x, double low) {
  const double z = x * x;
  double p = 1.0 / 355687428096000;
  p = p * z - 1.0 / 1307674368000;
  p = p * z + 1.0 / 6227020800;
  p = p * z - 1.0 / 39916800;
  p = p * z + 1.0 / 362880;
  p = p * z - 1.0 / 5040;
  p = p * z + 1.0 / 120;
  p = p * z - 1.0 / 6;
  return x + (x * z * p + low * (1 - z / 2));
}

/// Taylor series to degree 18, with 1 - z/2 rounded once.
double cos_kernel(double x, double low) {
  const double z = x * x;
  double p = -1.0 / 6402373705728000;
  p = p * z + 1.0 / 20922789888000;
  p = p * z - 1.0 / 87178291200;
  p = p * z + 1.0 / 479001600;
  p = p * z - 1.0 / 3628800;
  p = p * z + 1.0 / 40320;
  p = p * z - 1.0 / 720;
  p = p * z + 1.0 / 24;
  const double half = z / 2;
  const double head = 1 - half;
  return head + (((1 - head) - half) + (z * z * p - x * low));
}

double sin_in_quarter(const Reduced& r, unsigned quarter) {
  const double value = quarter & 1 ? cos_kernel(r.high, r.low) : sin_kernel(r.high, r.low);
  return quarter & 2 ? -value : value;
}

}  // namespace

// x = 2^k m with m in [sqrt(1/2), sqrt(2)]; log m = 2 artanh(s), s = f / (2 + f), f = m - 1, by
// its series in s^2 <= 0.0295, arranged so that f itself is added last.
double log(double x) {
  if (!(x > 0))
    return x == 0 ? -std::numeric_limits<double>::infinity()
                  : std::numeric_limits<double>::quiet_NaN();
  if (x == std::numeric_limits<double>::infinity()) return x;
  constexpr double kLn2High = 0x1.62e42feep-1;
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0x1.6a09e667f3bcdp-1) {
    m *= 2;
    --exponent;
  }
  const double f = m - 1;
  const double s = f / (2 + f);
  const double z = s * s;
  double p = 2.0 / 23;
  p = p * z + 2.0 / 21;
  p = p * z + 2.0 / 19;
  p = p * z + 2.0 / 17;
  p = p * z + 2.0 / 15;
  p = p * z + 2.0 / 13;
  p = p * z + 2.0 / 11;
  p = p * z + 2.0 / 9;
  p = p * z + 2.0 / 7;
  p = p * z + 2.0 / 5;
  p = p * z + 2.0 / 3;
  const double half_square = f * f / 2;
  const double k = exponent;
  // log m = 2 s + s z p = f - half_square + s (half_square + z p)
  return k * kLn2High - ((half_square - (s * (half_square + z * p) + k * kLn2Low)) - f);
}

double sin(double x) {
  const Reduced r = reduce(x);
  return sin_in_quarter(r, r.quarter);
}

double cos(double x) {
  const Reduced r = reduce(x);
  return sin_in_quarter(r, r.quarter + 1);
}

SinCos sin_cos(double x) {
  const Reduced r = reduce(x);
  const double s = sin_kernel(r.high, r.low);
  const double c = cos_kernel(r.high, r.low);
  const bool odd = r.quarter & 1;
  const double sine = odd ? c : s;
  const double cosine = odd ? s : c;
  return {r.quarter & 2 ? -sine : sine, (r.quarter + 1) & 2 ? -cosine : cosine};
}

}  // namespace pss
