// unite() of io/points/schema.h: one schema for points of several files.

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/points/raw_value.h"
#include "io/points/schema.h"

namespace pss {
namespace {

bool same_scale(const Dimension& a, const Dimension& b) {
  return a.scale == b.scale && a.offset == b.offset;
}

bool is_signed(Type type) { return integer_limits(type, 0).lowest != 0; }

/// The least integer type, signed or not, of at least so many bits; float64 where there is none.
Type integer_type(bool with_sign, std::size_t bits) {
  if (bits <= 8) return with_sign ? Type::kInt8 : Type::kUint8;
  if (bits <= 16) return with_sign ? Type::kInt16 : Type::kUint16;
  if (bits <= 32) return with_sign ? Type::kInt32 : Type::kUint32;
  if (bits <= 64) return with_sign ? Type::kInt64 : Type::kUint64;
  return Type::kFloat64;
}

Type wider_integer(Type a, Type b) {
  const bool with_sign = is_signed(a) || is_signed(b);
  const auto bits = [&](Type type) {
    return 8 * size_of(type) + (with_sign && !is_signed(type) ? 1 : 0);
  };
  return integer_type(with_sign, std::max(bits(a), bits(b)));
}

/// The narrowest type that holds the values of both; of 64-bit integers and floats, float64.
Type wider_type(Type a, Type b) {
  if (a == b) return a;
  if (!is_float(a) && !is_float(b)) return wider_integer(a, b);
  if (is_float(a) && is_float(b)) return Type::kFloat64;
  const Type floating = is_float(a) ? a : b;
  const Type integer = is_float(a) ? b : a;
  return size_of(integer) <= 2 ? floating : Type::kFloat64;
}

/// The values, scaled, that a dimension of integers can hold.
std::pair<double, double> range_of(const Dimension& d) {
  const IntegerLimits limits = integer_limits(d.type, d.width);
  const double low = -static_cast<double>(limits.lowest) * d.scale + d.offset;
  const double high = static_cast<double>(limits.highest) * d.scale + d.offset;
  return std::minmax({low, high});
}

/// Whether `fine` has the finer step and the range of `coarse`.
bool covers(const Dimension& fine, const Dimension& coarse) {
  if (is_float(fine.type) || is_float(coarse.type)) return false;
  const auto [low, high] = range_of(fine);
  const auto [other_low, other_high] = range_of(coarse);
  return std::abs(fine.scale) <= std::abs(coarse.scale) && low <= other_low && other_high <= high;
}

/// A dimension that holds the values of both.
Dimension merged(const Dimension& a, const Dimension& b) {
  Dimension both = a;
  both.count = std::max(a.count, b.count);
  if (a.width != 0 && b.width != 0) {
    both.width = std::max(a.width, b.width);
    both.type = wider_type(a.type, b.type);
  } else if (same_scale(a, b)) {
    both.width = 0;
    both.type = wider_type(a.width != 0 ? integer_type(false, a.width) : a.type,
                           b.width != 0 ? integer_type(false, b.width) : b.type);
  } else if (covers(b, a)) {
    both = b;
    both.count = std::max(a.count, b.count);
  } else if (!covers(a, b)) {
    both.type = Type::kFloat64;
    both.scale = 1;
    both.offset = 0;
    both.width = 0;
  }
  return both;
}

bool same_values(const Dimension& a, const Dimension& b) {
  return a.type == b.type && a.count == b.count && a.width == b.width && same_scale(a, b);
}

/// A field with nothing but this dimension.
Field field_of(const Dimension& d) {
  Field field{d.name, d.type, d.count, d.scale, d.offset, {}};
  if (d.width == 0) return field;
  field.type = integer_type(false, d.width);
  field.bits = {{d.name, 0, d.width}};
  return field;
}

std::string free_name(const Schema& schema, std::string name) {
  while (schema.find(name)) name += "_";
  return name;
}

/// Adds a container of `a`; bit fields that need more bits for `b` become fields of their own.
void add_container(Schema& result, const Field& field, const Schema& a, const Schema& b) {
  Field rest = field;
  rest.bits.clear();
  std::vector<Field> grown;
  for (const BitField& bits : field.bits) {
    const Dimension mine = *a.dimension(bits.name);
    const std::optional<Dimension> other = b.dimension(bits.name);
    Dimension both = other ? merged(mine, *other) : mine;
    if (both.width != 0 && both.width <= mine.width)
      rest.bits.push_back(bits);
    else
      grown.push_back(field_of(both));
  }
  if (!rest.bits.empty()) result.add(std::move(rest));
  for (Field& field_of_its_own : grown) result.add(std::move(field_of_its_own));
}

/// Adds what `result` has not yet of a field of `b`.
void add_missing(Schema& result, const Field& field) {
  Field rest = field;
  std::erase_if(rest.bits,
                [&](const BitField& bits) { return result.dimension(bits.name).has_value(); });
  const bool nothing =
      field.bits.empty() ? result.dimension(field.name).has_value() : rest.bits.empty();
  if (nothing) return;
  if (!rest.bits.empty()) rest.name = free_name(result, rest.name);
  result.add(std::move(rest));
}

}  // namespace

Schema unite(const Schema& a, const Schema& b) {
  Schema result;
  for (const Field& field : a.fields()) {
    if (!field.bits.empty()) {
      add_container(result, field, a, b);
      continue;
    }
    const std::optional<Dimension> other = b.dimension(field.name);
    const Dimension mine = *a.dimension(field.name);
    const Dimension both = other ? merged(mine, *other) : mine;
    result.add(same_values(mine, both) ? field : field_of(both));
  }
  for (const Field& field : b.fields()) add_missing(result, field);
  return result;
}

}  // namespace pss
