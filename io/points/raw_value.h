#pragma once
// Stored values of any Type as one integer or double, before scale and offset.

#include <cstddef>
#include <cstdint>

#include "io/points/schema.h"

namespace pss {

/// An integer of any sign and up to 64 bits, so that neither int64 nor uint64 is cut.
struct RawInteger {
  std::uint64_t magnitude = 0;
  bool negative = false;
};

/// Requires: the dimension is no float.
RawInteger load_integer(const Dimension& dimension, const std::byte* row, std::size_t element);
/// Stores the nearest value that the dimension can hold. Requires: the dimension is no float.
void store_integer(const Dimension& dimension, std::byte* row, RawInteger value,
                   std::size_t element);

/// The stored value, without scale and offset.
double load_double(const Dimension& dimension, const std::byte* row, std::size_t element);
/// Stores the nearest value that the dimension can hold; NaN in an integer is 0.
void store_double(const Dimension& dimension, std::byte* row, double value, std::size_t element);

/// The least and largest integers that a dimension can hold; `lowest` is a magnitude, negated.
struct IntegerLimits {
  std::uint64_t lowest = 0;
  std::uint64_t highest = 0;
};
IntegerLimits integer_limits(Type type, std::uint8_t width);

}  // namespace pss
