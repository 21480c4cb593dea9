#pragma once
// Which property of a PLY vertex is a coordinate and which one is an attribute.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/result.h"
#include "io/formats/ply/ply_header.h"
#include "io/points/schema.h"

namespace pss {

/// Where a property of a vertex goes in a point.
struct PlySlot {
  Type type = Type::kFloat32;
  std::optional<Type> length_type = {};  ///< of a list, which goes nowhere
  std::optional<std::size_t> axis = {};  ///< 0 to 2: a coordinate
  std::size_t row = 0;                   ///< byte in the row of an attribute
};

struct PlyLayout {
  std::vector<PlySlot> slots;  ///< one a property, in the file's order
  Schema schema;               ///< of the attributes: own names, own types
};

/// The properties that are x, y and z: so named, or, where one is missing, X, Y and Z.
///
/// Errors: kBadInput where there is none.
Result<std::array<std::size_t, 3>> ply_axes(const PlyElement& vertex, const std::string& path);

/// Errors: kBadInput where x, y or z is missing or a list.
Result<PlyLayout> ply_layout(const PlyElement& vertex, const std::string& path);

/// Puts a property's value into a point. Shape: size_of(slot.type) little-endian bytes.
void place_value(const PlySlot& slot, const std::byte* value, World3& position, std::byte* row);

}  // namespace pss
