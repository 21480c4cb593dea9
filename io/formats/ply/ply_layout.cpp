#include "io/formats/ply/ply_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace pss {
namespace {

template <class T>
double load_as(const std::byte* place) {
  T value{};
  std::memcpy(&value, place, sizeof value);
  return static_cast<double>(value);
}

double coordinate(Type type, const std::byte* place) {
  switch (type) {
    case Type::kInt8:
      return load_as<std::int8_t>(place);
    case Type::kUint8:
      return load_as<std::uint8_t>(place);
    case Type::kInt16:
      return load_as<std::int16_t>(place);
    case Type::kUint16:
      return load_as<std::uint16_t>(place);
    case Type::kInt32:
      return load_as<std::int32_t>(place);
    case Type::kUint32:
      return load_as<std::uint32_t>(place);
    case Type::kInt64:
      return load_as<std::int64_t>(place);
    case Type::kUint64:
      return load_as<std::uint64_t>(place);
    case Type::kFloat32:
      return load_as<float>(place);
    case Type::kFloat64:
      return load_as<double>(place);
  }
  return 0;
}

std::optional<std::size_t> find_scalar(const PlyElement& element, char name) {
  const auto& properties = element.properties;
  const auto named = [name](const PlyProperty& property) {
    return property.name.size() == 1 && property.name[0] == name && !property.length_type;
  };
  const auto found = std::ranges::find_if(properties, named);
  if (found == properties.end()) return std::nullopt;
  return static_cast<std::size_t>(found - properties.begin());
}

}  // namespace

Result<std::array<std::size_t, 3>> ply_axes(const PlyElement& vertex, const std::string& path) {
  std::array<std::size_t, 3> axes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto place = find_scalar(vertex, "xyz"[axis]);
    if (!place) place = find_scalar(vertex, "XYZ"[axis]);
    if (!place)
      return Error{Fault::kBadInput,
                   fmt::format("{}: the vertices have no property '{}'; expected x, y and z", path,
                               "xyz"[axis])};
    axes[axis] = *place;
  }
  return axes;
}

Result<PlyLayout> ply_layout(const PlyElement& vertex, const std::string& path) {
  PSS_ASSIGN(const auto axes, ply_axes(vertex, path));
  PlyLayout layout;
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    PlySlot slot{.type = property.type, .length_type = property.length_type};
    const auto axis = std::ranges::find(axes, i);
    if (axis != axes.end()) {
      slot.axis = static_cast<std::size_t>(axis - axes.begin());
    } else if (!property.length_type) {
      slot.row = layout.schema.row_size();
      layout.schema.add({property.name, property.type, 1, 1, 0, {}});
    }
    layout.slots.push_back(slot);
  }
  return layout;
}

void place_value(const PlySlot& slot, const std::byte* value, World3& position, std::byte* row) {
  if (slot.axis) {
    position[*slot.axis] = coordinate(slot.type, value);
  } else {
    std::memcpy(row + slot.row, value, size_of(slot.type));
  }
}

}  // namespace pss
