#pragma once
// Numbers as text: exact in both directions, and independent of the locale.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/points/schema.h"

namespace pss {

enum class NumberFault : std::uint8_t { kNone, kNoNumber, kOutOfRange };

/// Reads a whole token as the double nearest to it: a leading '+', nan and inf are fine.
NumberFault parse_number(std::string_view token, double& value);

/// Reads a whole token as a value of `type`, stored at `out`.
///
/// Integers may be written as 12.0 or 1e3 where that is whole. A float too small for its type is 0.
NumberFault parse_number(std::string_view token, Type type, std::byte* out);

/// What to say of a fault: "is not a number", "is out of the range of uint8".
std::string describe(NumberFault fault, Type type);

/// Appends the shortest text that reads back as the same value.
void append_number(double value, std::string& text);
void append_number(float value, std::string& text);
/// The same for a stored value of any type. Requires: size_of(type) bytes at `place`.
void append_number(Type type, const std::byte* place, std::string& text);

/// Appends the number of fewest decimals within `tolerance` of a value that is a sum or product of
/// decimal numbers (origin + scale * index), so that 0.1 * 3 is written as 0.3.
void append_decimal(double value, double tolerance, std::string& text);

/// A token for an error message: at most 40 characters of it, unprintable ones as '?', in quotes.
std::string in_quotes(std::string_view token);

}  // namespace pss
