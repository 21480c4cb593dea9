#include "io/points/schema.h"

#include <algorithm>
#include <array>
#include <utility>

#include "io/points/raw_value.h"

namespace pss {
namespace {

struct TypeFacts {
  const char* name;
  std::size_t size;
};

constexpr std::array<TypeFacts, 10> kTypes{{{"int8", 1},
                                            {"uint8", 1},
                                            {"int16", 2},
                                            {"uint16", 2},
                                            {"int32", 4},
                                            {"uint32", 4},
                                            {"int64", 8},
                                            {"uint64", 8},
                                            {"float32", 4},
                                            {"float64", 8}}};

Dimension whole(const Field& field, std::size_t position) {
  return {field.name, field.type, field.count, field.scale, field.offset, position, 0, 0};
}

Dimension part(const Field& field, const BitField& bits, std::size_t position) {
  return {bits.name, field.type, 1, 1, 0, position, bits.shift, bits.width};
}

}  // namespace

std::size_t size_of(Type type) { return kTypes[static_cast<std::size_t>(type)].size; }

const char* type_name(Type type) { return kTypes[static_cast<std::size_t>(type)].name; }

bool is_float(Type type) { return type == Type::kFloat32 || type == Type::kFloat64; }

Schema::Schema(std::vector<Field> fields) {
  for (Field& field : fields) add(std::move(field));
}

void Schema::add(Field field) {
  positions_.push_back(row_size_);
  row_size_ += field.size();
  fields_.push_back(std::move(field));
}

std::optional<std::size_t> Schema::find(std::string_view field_name) const {
  const auto found = std::ranges::find(fields_, field_name, &Field::name);
  if (found == fields_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - fields_.begin());
}

std::vector<Dimension> Schema::dimensions() const {
  std::vector<Dimension> all;
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    if (fields_[f].bits.empty()) all.push_back(whole(fields_[f], positions_[f]));
    for (const BitField& bits : fields_[f].bits)
      all.push_back(part(fields_[f], bits, positions_[f]));
  }
  return all;
}

std::optional<Dimension> Schema::dimension(std::string_view name) const {
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    const Field& field = fields_[f];
    if (field.bits.empty() && field.name == name) return whole(field, positions_[f]);
    const auto bits = std::ranges::find(field.bits, name, &BitField::name);
    if (bits != field.bits.end()) return part(field, *bits, positions_[f]);
  }
  return std::nullopt;
}

double read_value(const Dimension& dimension, const std::byte* row, std::size_t element) {
  return load_double(dimension, row, element) * dimension.scale + dimension.offset;
}

void write_value(const Dimension& dimension, std::byte* row, double value, std::size_t element) {
  store_double(dimension, row, (value - dimension.offset) / dimension.scale, element);
}

}  // namespace pss
