// RowMapper of io/points/schema.h: rows of one schema as rows of another.

#include <algorithm>
#include <cassert>
#include <cstring>

#include "io/points/raw_value.h"
#include "io/points/schema.h"

namespace pss {
namespace {

bool same_bytes(const Field& a, const Field& b) {
  if (a.type != b.type || a.count != b.count || a.bits != b.bits) return false;
  return !a.bits.empty() || (a.name == b.name && a.scale == b.scale && a.offset == b.offset);
}

/// The field of `schema` whose bytes may be copied into `field`.
std::optional<std::size_t> twin(const Schema& schema, const Field& field) {
  const auto found = std::ranges::find_if(
      schema.fields(), [&](const Field& other) { return same_bytes(other, field); });
  if (found == schema.fields().end()) return std::nullopt;
  return static_cast<std::size_t>(found - schema.fields().begin());
}

/// Whether some value of `from` has no equal in `to`.
bool narrows(const Dimension& from, const Dimension& to) {
  if (to.type == Type::kFloat64) return size_of(from.type) == 8 && !is_float(from.type);
  if (from.count > to.count || is_float(from.type)) return true;
  if (to.type == Type::kFloat32) return from.width == 0 && size_of(from.type) > 2;
  if (from.scale != to.scale || from.offset != to.offset) return true;
  const IntegerLimits in = integer_limits(from.type, from.width);
  const IntegerLimits out = integer_limits(to.type, to.width);
  return in.lowest > out.lowest || in.highest > out.highest;
}

void convert(const Dimension& from, const Dimension& to, const std::byte* in, std::byte* out,
             std::size_t element) {
  if (from.scale != to.scale || from.offset != to.offset)
    write_value(to, out, read_value(from, in, element), element);
  else if (is_float(from.type) || is_float(to.type))
    store_double(to, out, load_double(from, in, element), element);
  else
    store_integer(to, out, load_integer(from, in, element), element);
}

}  // namespace

RowMapper::RowMapper(const Schema& from, const Schema& to)
    : from_size_(from.row_size()), to_size_(to.row_size()), identity_(from == to) {
  for (std::size_t f = 0; f < to.fields().size(); ++f) {
    const Field& field = to.fields()[f];
    if (const auto source = twin(from, field)) {
      add_copy({from.position(*source), to.position(f), field.size()});
      continue;
    }
    if (field.bits.empty()) add_convert(from, to, field.name);
    for (const BitField& bits : field.bits) add_convert(from, to, bits.name);
  }
  for (const Dimension& dimension : from.dimensions())
    if (!to.dimension(dimension.name)) dropped_.push_back(dimension.name);
}

void RowMapper::add_copy(const Copy& copy) {
  if (!copies_.empty()) {
    Copy& last = copies_.back();
    if (last.from + last.size == copy.from && last.to + last.size == copy.to) {
      last.size += copy.size;
      return;
    }
  }
  copies_.push_back(copy);
}

void RowMapper::add_convert(const Schema& from, const Schema& to, const std::string& name) {
  const std::optional<Dimension> source = from.dimension(name);
  if (!source) return;
  const Dimension target = *to.dimension(name);
  converts_.push_back({*source, target});
  if (narrows(*source, target)) narrowed_.push_back(name);
}

void RowMapper::map(std::span<const std::byte> from, std::span<std::byte> to) const {
  if (to.empty()) return;
  if (identity_) {
    assert(from.size() == to.size());
    std::memcpy(to.data(), from.data(), from.size());
    return;
  }
  const std::size_t rows = to.size() / to_size_;
  assert(from.size() == rows * from_size_);
  std::ranges::fill(to, std::byte{0});
  for (std::size_t i = 0; i < rows; ++i) {
    const std::byte* in = from.data() + i * from_size_;
    std::byte* out = to.data() + i * to_size_;
    for (const Copy& copy : copies_) std::memcpy(out + copy.to, in + copy.from, copy.size);
    for (const Convert& pair : converts_)
      for (std::uint32_t e = 0; e < std::min(pair.from.count, pair.to.count); ++e)
        convert(pair.from, pair.to, in, out, e);
  }
}

}  // namespace pss
