#include "io/points/raw_value.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace pss {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are little-endian in memory");

bool is_signed(Type type) {
  return type == Type::kInt8 || type == Type::kInt16 || type == Type::kInt32 ||
         type == Type::kInt64;
}

std::uint64_t low_bits(unsigned count) {
  return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

std::size_t offset_of(const Dimension& dimension, std::size_t element) {
  return dimension.position + element * size_of(dimension.type);
}

/// The value's bytes, zero-extended.
std::uint64_t load_bits(const Dimension& dimension, const std::byte* row, std::size_t element) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, row + offset_of(dimension, element), size_of(dimension.type));
  return bits;
}

void store_bits(const Dimension& dimension, std::byte* row, std::uint64_t bits,
                std::size_t element) {
  std::memcpy(row + offset_of(dimension, element), &bits, size_of(dimension.type));
}

/// Negates in two's complement: the magnitude of a negative value and back.
std::uint64_t negated(std::uint64_t bits) { return ~bits + 1; }

std::uint64_t magnitude_of(double value, std::uint64_t highest) {
  const double rounded = std::nearbyint(std::abs(value));
  // 2^64 as a double: what is not below it has no uint64, also infinity.
  return rounded < 18446744073709551616.0 ? std::min(static_cast<std::uint64_t>(rounded), highest)
                                          : highest;
}

float nearest_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::isfinite(value) ? std::clamp(value, -kLargest, kLargest) : value);
}

}  // namespace

IntegerLimits integer_limits(Type type, std::uint8_t width) {
  const unsigned bits = width != 0 ? width : static_cast<unsigned>(8 * size_of(type));
  if (width != 0 || !is_signed(type)) return {0, low_bits(bits)};
  return {std::uint64_t{1} << (bits - 1), low_bits(bits - 1)};
}

RawInteger load_integer(const Dimension& dimension, const std::byte* row, std::size_t element) {
  const std::uint64_t bits = load_bits(dimension, row, element);
  if (dimension.width != 0) return {(bits >> dimension.shift) & low_bits(dimension.width), false};
  if (!is_signed(dimension.type)) return {bits, false};
  const unsigned unused = static_cast<unsigned>(64 - 8 * size_of(dimension.type));
  const std::int64_t value = static_cast<std::int64_t>(bits << unused) >> unused;
  if (value >= 0) return {static_cast<std::uint64_t>(value), false};
  return {negated(static_cast<std::uint64_t>(value)), true};
}

void store_integer(const Dimension& dimension, std::byte* row, RawInteger value,
                   std::size_t element) {
  const IntegerLimits limits = integer_limits(dimension.type, dimension.width);
  const std::uint64_t bits = value.negative ? negated(std::min(value.magnitude, limits.lowest))
                                            : std::min(value.magnitude, limits.highest);
  if (dimension.width == 0) return store_bits(dimension, row, bits, element);
  const std::uint64_t mask = low_bits(dimension.width) << dimension.shift;
  const std::uint64_t others = load_bits(dimension, row, element) & ~mask;
  store_bits(dimension, row, others | (bits << dimension.shift), element);
}

double load_double(const Dimension& dimension, const std::byte* row, std::size_t element) {
  const std::byte* place = row + offset_of(dimension, element);
  if (dimension.type == Type::kFloat32) {
    float value = 0;
    std::memcpy(&value, place, sizeof value);
    return value;
  }
  if (dimension.type == Type::kFloat64) {
    double value = 0;
    std::memcpy(&value, place, sizeof value);
    return value;
  }
  const RawInteger value = load_integer(dimension, row, element);
  const double magnitude = static_cast<double>(value.magnitude);
  return value.negative ? -magnitude : magnitude;
}

void store_double(const Dimension& dimension, std::byte* row, double value, std::size_t element) {
  std::byte* place = row + offset_of(dimension, element);
  if (dimension.type == Type::kFloat32) {
    const float narrow = nearest_float(value);
    std::memcpy(place, &narrow, sizeof narrow);
  } else if (dimension.type == Type::kFloat64) {
    std::memcpy(place, &value, sizeof value);
  } else if (std::isnan(value)) {
    store_integer(dimension, row, {}, element);
  } else {
    const IntegerLimits limits = integer_limits(dimension.type, dimension.width);
    const bool negative = value < 0;
    const std::uint64_t most = negative ? limits.lowest : limits.highest;
    store_integer(dimension, row, {magnitude_of(value, most), negative}, element);
  }
}

}  // namespace pss
