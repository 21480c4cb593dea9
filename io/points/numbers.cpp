#include "io/points/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "io/points/raw_value.h"

namespace pss {
namespace {

std::string_view without_plus(std::string_view token) {
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+';
  return plus ? token.substr(1) : token;
}

template <class T>
std::errc parse_whole(std::string_view token, T& value) {
  const auto [end, fault] = std::from_chars(token.data(), token.data() + token.size(), value);
  return end == token.data() + token.size() ? fault : std::errc::invalid_argument;
}

/// Of an exponent that is larger than any number of digits, its sign is enough.
std::int64_t parse_exponent(std::string_view text) {
  constexpr std::int64_t kFar = std::int64_t{1} << 62;
  std::int64_t exponent = text.starts_with('-') ? -kFar : kFar;
  static_cast<void>(parse_whole(without_plus(text), exponent));
  return std::clamp(exponent, -kFar, kFar);
}

/// Whether a decimal number is below 1, by its exponent and the place of its first digit.
bool is_below_one(std::string_view token) {
  const std::size_t end = std::min(token.find_first_of("eE"), token.size());
  const std::string_view digits = token.substr(0, end);
  const auto first = static_cast<std::int64_t>(digits.find_first_of("123456789"));
  const auto point = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  const std::int64_t before = point > first ? point - first : point - first + 1;
  return before + (end < token.size() ? parse_exponent(token.substr(end + 1)) : 0) <= 0;
}

/// from_chars says "out of range" both of 1e999 and of 1e-999; the second one is 0 (or denormal).
template <class T>
NumberFault parse_tiny(std::string_view token, T& value) {
  if (!is_below_one(token)) return NumberFault::kOutOfRange;
  long double wide = token.starts_with('-') ? -0.0L : 0.0L;  // stays so where it is too small, too
  static_cast<void>(parse_whole(token, wide));
  value = static_cast<T>(wide);
  return NumberFault::kNone;
}

template <class T>
requires std::is_floating_point_v<T> NumberFault parse_value(std::string_view token, T& value) {
  token = without_plus(token);
  const std::errc fault = parse_whole(token, value);
  if (fault == std::errc::result_out_of_range) return parse_tiny(token, value);
  return fault == std::errc{} ? NumberFault::kNone : NumberFault::kNoNumber;
}

template <class T>
NumberFault whole_value(std::string_view token, T& value) {
  double wide = 0;
  if (parse_value(token, wide) != NumberFault::kNone || std::isnan(wide))
    return NumberFault::kNoNumber;
  if (std::isfinite(wide) && wide != std::nearbyint(wide)) return NumberFault::kNoNumber;
  constexpr double kEnd = 2.0 * static_cast<double>(std::numeric_limits<T>::max() / 2 + 1);
  if (wide < static_cast<double>(std::numeric_limits<T>::min()) || wide >= kEnd)
    return NumberFault::kOutOfRange;
  value = static_cast<T>(wide);
  return NumberFault::kNone;
}

template <class T>
requires std::is_integral_v<T> NumberFault parse_value(std::string_view token, T& value) {
  const std::errc fault = parse_whole(without_plus(token), value);
  if (fault == std::errc{}) return NumberFault::kNone;
  if (fault == std::errc::result_out_of_range) return NumberFault::kOutOfRange;
  return whole_value(token, value);
}

template <class T>
NumberFault parse_and_store(std::string_view token, std::byte* out) {
  T value{};
  const NumberFault fault = parse_value(token, value);
  if (fault == NumberFault::kNone) std::memcpy(out, &value, sizeof value);
  return fault;
}

template <class T>
void append_chars(T value, std::string& text) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  text.append(buffer, result.ptr);
}

/// Plain digits where they are few enough: 500000 rather than 5e+05.
template <class T>
void append_float(T value, std::string& text) {
  const T magnitude = std::abs(value);
  if (magnitude != 0 && !(magnitude >= T(1e-5) && magnitude < T(1e15)))
    return append_chars(value, text);
  char buffer[64];
  const auto result =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed);
  text.append(buffer, result.ptr);
}

template <class T>
void load_and_append(const std::byte* place, std::string& text) {
  T value{};
  std::memcpy(&value, place, sizeof value);
  if constexpr (std::is_floating_point_v<T>) {
    append_float(value, text);
  } else {
    append_chars(value, text);
  }
}

/// Appends mantissa / 10^decimals.
void append_fixed(std::int64_t mantissa, int decimals, std::string& text) {
  if (mantissa < 0) text.push_back('-');
  const std::string digits = fmt::format("{:0{}}", std::abs(mantissa), decimals + 1);
  const std::size_t point = digits.size() - static_cast<std::size_t>(decimals);
  text.append(digits, 0, point);
  if (decimals > 0) text.append(1, '.').append(digits, point);
}

}  // namespace

NumberFault parse_number(std::string_view token, double& value) {
  return parse_value(token, value);
}

NumberFault parse_number(std::string_view token, Type type, std::byte* out) {
  switch (type) {
    case Type::kInt8:
      return parse_and_store<std::int8_t>(token, out);
    case Type::kUint8:
      return parse_and_store<std::uint8_t>(token, out);
    case Type::kInt16:
      return parse_and_store<std::int16_t>(token, out);
    case Type::kUint16:
      return parse_and_store<std::uint16_t>(token, out);
    case Type::kInt32:
      return parse_and_store<std::int32_t>(token, out);
    case Type::kUint32:
      return parse_and_store<std::uint32_t>(token, out);
    case Type::kInt64:
      return parse_and_store<std::int64_t>(token, out);
    case Type::kUint64:
      return parse_and_store<std::uint64_t>(token, out);
    case Type::kFloat32:
      return parse_and_store<float>(token, out);
    case Type::kFloat64:
      return parse_and_store<double>(token, out);
  }
  return NumberFault::kNoNumber;
}

std::string describe(NumberFault fault, Type type) {
  if (fault == NumberFault::kOutOfRange)
    return fmt::format("is out of the range of {}", type_name(type));
  return is_float(type) ? "is not a number" : fmt::format("is no {}", type_name(type));
}

void append_number(double value, std::string& text) { append_float(value, text); }

void append_number(float value, std::string& text) { append_float(value, text); }

void append_number(Type type, const std::byte* place, std::string& text) {
  if (type == Type::kFloat32) return load_and_append<float>(place, text);
  if (type == Type::kFloat64) return load_and_append<double>(place, text);
  const RawInteger value = load_integer({.name = {}, .type = type}, place, 0);
  if (value.negative) text.push_back('-');
  append_chars(value.magnitude, text);
}

void append_decimal(double value, double tolerance, std::string& text) {
  constexpr double kExact = 9007199254740992.0;  // 2^53
  double power = 1;
  for (int decimals = 0; decimals <= 15; ++decimals, power *= 10) {
    const double mantissa = std::nearbyint(value * power);
    if (!(std::abs(mantissa) < kExact)) break;
    if (std::abs(mantissa / power - value) <= tolerance)
      return append_fixed(static_cast<std::int64_t>(mantissa), decimals, text);
  }
  append_number(value, text);
}

std::string in_quotes(std::string_view token) {
  constexpr std::size_t kMost = 40;
  std::string text = "'";
  for (const char c : token.substr(0, kMost)) text.push_back(c >= ' ' && c <= '~' ? c : '?');
  return text + (token.size() > kMost ? "...'" : "'");
}

}  // namespace pss
