#include "stream/passes/normals.h"

#include <cassert>
#include <vector>

#include "core/sorted_cloud.h"

namespace pss {
namespace {

constexpr std::array kNames{"NormalX", "NormalY", "NormalZ"};

std::array<std::string, 3> computed_names() {
  std::array<std::string, 3> names;
  for (std::size_t a = 0; a < 3; ++a) names[a] = std::string(kComputedPrefix) + kNames[a];
  return names;
}

bool can_hold_components(const Field& field) {
  return field.count == 1 && field.bits.empty() && (is_float(field.type) || field.scale != 1);
}

Dimension as_dimension(const Field& field) {
  return {field.name, field.type, 1, field.scale, field.offset, 0, 0, 0};
}

}  // namespace

const char* name_of(NormalsFrom from) {
  switch (from) {
    case NormalsFrom::kInput:
      return "given";
    case NormalsFrom::kFirstPass:
      return "computed";
    default:
      return "";
  }
}

NormalsFrom normals_named(std::string_view name) {
  for (const NormalsFrom from : {NormalsFrom::kInput, NormalsFrom::kFirstPass})
    if (name == name_of(from)) return from;
  return NormalsFrom::kNowhere;
}

std::optional<NormalColumns> NormalColumns::find(const Schema& schema,
                                                 const std::array<std::string, 3>& names) {
  NormalColumns columns;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::optional<std::size_t> field = schema.find(names[a]);
    if (!field || !can_hold_components(schema.fields()[*field])) return std::nullopt;
    columns.fields_[a] = *field;
  }
  return columns;
}

std::optional<NormalColumns> NormalColumns::given(const Schema& schema) {
  if (auto columns = find(schema, {kNames[0], kNames[1], kNames[2]})) return columns;
  return find(schema, {"nx", "ny", "nz"});
}

std::optional<NormalColumns> NormalColumns::computed(const Schema& schema) {
  return find(schema, computed_names());
}

Result<void> NormalColumns::read(const Source& source, std::size_t tile, const BlockInfo& block,
                                 std::span<Normal> out) const {
  assert(out.size() == block.count);
  std::vector<World3> components(block.count);
  std::vector<std::byte> values;
  for (std::size_t a = 0; a < 3; ++a) {
    const Field& field = source.schema().fields()[fields_[a]];
    const Dimension dimension = as_dimension(field);
    values.resize(block.count * field.size());
    PSS_TRY(source.read_field(tile, block, fields_[a], values));
    for (std::size_t i = 0; i < block.count; ++i)
      components[i][a] = read_value(dimension, &values[i * field.size()]);
  }
  for (std::size_t i = 0; i < block.count; ++i) out[i] = unit_normal(components[i]);
  return {};
}

NormalsFrom normals_from(const Schema& schema, const Method& method) {
  if (!needs_normals(method.op)) return NormalsFrom::kNowhere;
  return NormalColumns::given(schema) ? NormalsFrom::kInput : NormalsFrom::kFirstPass;
}

Schema without_computed_normals(const Schema& schema) {
  std::vector<Field> fields = schema.fields();
  const std::array<std::string, 3> names = computed_names();
  if (fields.size() < 3) return schema;
  for (std::size_t a = 0; a < 3; ++a)
    if (fields[fields.size() - 3 + a].name != names[a]) return schema;
  fields.resize(fields.size() - 3);
  return Schema(std::move(fields));
}

}  // namespace pss
