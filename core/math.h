#pragma once
// Elementary functions whose bits are the same on every machine, which libm's are not.

#include <bit>
#include <cstdint>
#include <limits>

namespace pss {

/// Added and subtracted again, it rounds a double of magnitude below 2^51 to the nearest integer.
inline constexpr double kRoundingShift = 0x1.8p52;

/// e^x within 1 ulp; +0 below -707, so that no result is subnormal.
///
/// Free of branches and tables: loops over it vectorise.
/// Source: x = k ln2 + r, |r| <= ln2/2, k ln2 in two parts (Cody, Waite, "Software Manual for the
///         Elementary Functions", 1980); Taylor series of degree 13, remainder below 2^-57.
inline double exp(double x) {
  constexpr double kLowest = -707;
  constexpr double kHighest = 0x1.62e42fefa39efp+9;  // the largest double whose e^x is finite
  constexpr double kLog2E = 0x1.71547652b82fep+0;
  constexpr double kLn2High = 0x1.62e42feep-1;
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  double c = x < kLowest ? kLowest : x;
  c = c > kHighest ? kHighest : c;
  const double shifted = c * kLog2E + kRoundingShift;
  const double k = shifted - kRoundingShift;
  const double r = (c - k * kLn2High) - k * kLn2Low;
  double p = 1.0 / 6227020800;
  p = p * r + 1.0 / 479001600;
  p = p * r + 1.0 / 39916800;
  p = p * r + 1.0 / 3628800;
  p = p * r + 1.0 / 362880;
  p = p * r + 1.0 / 40320;
  p = p * r + 1.0 / 5040;
  p = p * r + 1.0 / 720;
  p = p * r + 1.0 / 120;
  p = p * r + 1.0 / 24;
  p = p * r + 1.0 / 6;
  p = p * r + 0.5;
  const double mantissa = 1 + (r + r * r * p);
  // The low bits of `shifted` hold k; the exponent field becomes that of 2^(k-1).
  const double half_scale =
      std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1022) << 52);
  const double result = mantissa * half_scale * 2;
  const double high = x > kHighest ? std::numeric_limits<double>::infinity() : result;
  return x < kLowest ? 0 : high;
}

/// Natural logarithm within 2 ulp; -infinity at 0, NaN below.
double log(double x);

/// Sine and cosine within 2 ulp for |x| below 1.6e6; meaningless, but the same, beyond.
double sin(double x);
double cos(double x);

}  // namespace pss
