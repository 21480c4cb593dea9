#pragma once
// Random numbers that are a function of a seed and a counter, the same on every machine.

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/math.h"

namespace pss {

/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

constexpr std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter) {
  return mix_bits(mix_bits(seed + 0x9e3779b97f4a7c15) + counter * 0x9e3779b97f4a7c15);
}

/// The fraction bits / 2^64, within [0, 1).
constexpr double unit_fraction(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// The largest |random_normal|.
inline constexpr double kLargestNormal = 8.6;

/// A number of the standard normal distribution. Source: Box, Muller, 1958.
inline double random_normal(std::uint64_t seed, std::uint64_t counter) {
  const std::uint64_t bits = random_bits(seed, counter);
  const double above_zero = unit_fraction(bits) + 0x1p-53;
  const double turn = unit_fraction(mix_bits(bits)) - 0.5;
  return std::sqrt(-2 * log(above_zero)) * cos(2 * std::numbers::pi * turn);
}

}  // namespace pss
