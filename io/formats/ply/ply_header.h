#pragma once
// The header of a PLY file: its words, read from and written as text.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "io/points/schema.h"

namespace pss {

enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  Type type = Type::kFloat32;            ///< of the value, or of a list's items
  std::string spelling = "float";        ///< the file's word for the type: "float" or "float32"
  std::optional<Type> length_type = {};  ///< of a list's length; nothing: the property is no list
  std::string length_spelling = {};
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties = {};
};

/// What stands between "ply" and "end_header".
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kLittleEndian;
  std::vector<std::string> comments;  ///< whole "comment" and "obj_info" lines, in order
  std::vector<PlyElement> elements;
  std::uint64_t size = 0;   ///< bytes, the end of the last line included
  std::uint64_t lines = 0;  ///< the last one included

  /// The place of an element among the elements.
  std::optional<std::size_t> find(std::string_view name) const;
};

/// Headers that are longer, or have more properties or elements, are refused.
inline constexpr std::size_t kPlyHeaderLimit = std::size_t{1} << 20;
inline constexpr std::size_t kPlyPropertyLimit = 1000;

/// Reads a header from the first bytes of a file (as many as kPlyHeaderLimit, or all there are).
///
/// Lines may end with "\n", "\r\n", or "\r" (where the first one does).
/// Errors: kBadInput with the line, what was found, what was expected.
Result<PlyHeader> parse_ply_header(std::string_view head, const std::string& path);

std::string format_ply_header(const PlyHeader& header);

/// PLY's own word for a type; int64 and uint64 have none.
std::optional<std::string_view> ply_type_name(Type type);

/// The bytes of an element's entry, lists counted as their length alone.
std::size_t least_size(const PlyElement& element);
bool has_lists(const PlyElement& element);

}  // namespace pss
