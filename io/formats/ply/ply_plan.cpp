#include "io/formats/ply/ply_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/formats/ply/ply_format.h"
#include "io/formats/ply/ply_layout.h"
#include "io/points/raw_value.h"

namespace pss {
namespace {

constexpr std::array<std::string_view, 3> kNormals{"NormalX", "NormalY", "NormalZ"};
constexpr std::array<std::string_view, 3> kNormalProperties{"nx", "ny", "nz"};

/// A value of the schema and the property it becomes.
struct Offer {
  std::string name;
  PlySource source;
  bool taken = false;
};

/// Whether every value of type `b` is one of type `a`.
bool holds(Type a, Type b) {
  if (a == b || a == Type::kFloat64) return a == b || size_of(b) < 8;
  if (a == Type::kFloat32) return !is_float(b) && size_of(b) <= 2;
  if (is_float(b)) return false;
  const IntegerLimits outer = integer_limits(a, 0);
  const IntegerLimits inner = integer_limits(b, 0);
  return inner.lowest <= outer.lowest && inner.highest <= outer.highest;
}

Type smallest_for(std::uint8_t width) {
  return width <= 8 ? Type::kUint8 : width <= 16 ? Type::kUint16 : Type::kUint32;
}

bool is_scaled(const Dimension& dimension) { return dimension.scale != 1 || dimension.offset != 0; }

/// The type of the property for a dimension: PLY has no 64-bit integers and no scale.
Type property_type(const Dimension& dimension) {
  if (is_scaled(dimension) || !ply_type_name(dimension.type)) return Type::kFloat64;
  return dimension.width != 0 ? smallest_for(dimension.width) : dimension.type;
}

/// Words of a header cannot have blanks.
std::string as_word(std::string name) {
  for (char& c : name)
    if (c <= ' ' || c == 127) c = '_';
  return name.empty() ? "unnamed" : name;
}

std::string property_name(const Dimension& dimension, std::size_t element) {
  const auto normal = std::ranges::find(kNormals, dimension.name);
  if (normal != kNormals.end())
    return std::string(kNormalProperties[static_cast<std::size_t>(normal - kNormals.begin())]);
  const std::string name = as_word(dimension.name);
  return dimension.count == 1 ? name : fmt::format("{}_{}", name, element);
}

/// nx, ny or nz in a schema that also has new normals.
bool is_replaced(const Schema& schema, const std::string& name) {
  const auto old = std::ranges::find(kNormalProperties, name);
  if (old == kNormalProperties.end()) return false;
  const auto axis = static_cast<std::size_t>(old - kNormalProperties.begin());
  return schema.dimension(kNormals[axis]).has_value();
}

std::vector<Offer> offers_of(const Schema& schema) {
  std::vector<Offer> offers;
  for (const Dimension& dimension : schema.dimensions()) {
    if (is_replaced(schema, dimension.name)) continue;
    for (std::size_t element = 0; element < dimension.count; ++element) {
      PlySource source{.dimension = dimension, .element = element};
      source.type = property_type(dimension);
      offers.push_back({property_name(dimension, element), std::move(source)});
    }
  }
  return offers;
}

class Planner {
 public:
  explicit Planner(const WriteOptions& options) : offers_(offers_of(options.schema)) {}

  /// Follows the vertices of the file that the points came from.
  Result<void> follow(const PlyElement& vertices, const std::string& path);
  void start_afresh();
  void append_rest();
  PlyPlan finish(PlyHeader header, std::uint64_t count);

 private:
  void add(PlyProperty property, PlySource source);
  void follow_property(const PlyProperty& property);
  std::string free_name(std::string name) const;

  std::vector<Offer> offers_;
  PlyElement vertex_{.name = "vertex"};
  PlyPlan plan_;
};

void Planner::add(PlyProperty property, PlySource source) {
  if (property.type != source.type || property.spelling.empty())
    property.spelling = ply_type_name(source.type).value_or("double");
  property.type = source.type;
  const Dimension& from = source.dimension;
  source.verbatim = !source.axis && from.width == 0 && !is_scaled(from) && from.type == source.type;
  vertex_.properties.push_back(std::move(property));
  plan_.sources.push_back(std::move(source));
}

Result<void> Planner::follow(const PlyElement& vertices, const std::string& path) {
  PSS_ASSIGN(const auto axes, ply_axes(vertices, path));
  for (std::size_t i = 0; i < vertices.properties.size(); ++i) {
    const PlyProperty& property = vertices.properties[i];
    const auto axis = std::ranges::find(axes, i);
    if (axis != axes.end()) {
      add(property, {.type = property.type, .axis = static_cast<std::size_t>(axis - axes.begin())});
    } else if (!property.length_type) {
      follow_property(property);
    }
  }
  return {};
}

/// Keeps the property's type unless the schema's, widened by other inputs, has more values.
void Planner::follow_property(const PlyProperty& property) {
  const auto offer = std::ranges::find(offers_, property.name, &Offer::name);
  if (offer == offers_.end()) {
    plan_.notes.push_back(fmt::format("property '{}' is dropped", property.name));
    return;
  }
  offer->taken = true;
  if (holds(property.type, offer->source.type)) offer->source.type = property.type;
  add(property, offer->source);
}

void Planner::start_afresh() {
  for (std::size_t axis = 0; axis < 3; ++axis)
    add({.name = std::string(1, "xyz"[axis]), .type = Type::kFloat64, .spelling = "double"},
        {.type = Type::kFloat64, .axis = axis});
}

void Planner::append_rest() {
  for (Offer& offer : offers_) {
    if (offer.taken) continue;
    const Dimension& from = offer.source.dimension;
    if (!ply_type_name(from.type) && from.width == 0 && !is_scaled(from))
      plan_.notes.push_back(
          fmt::format("'{}' is {}, which PLY lacks: written as double, exact up to 2^53", from.name,
                      type_name(from.type)));
    add({.name = free_name(offer.name), .type = offer.source.type, .spelling = ""}, offer.source);
  }
}

std::string Planner::free_name(std::string name) const {
  while (std::ranges::find(vertex_.properties, name, &PlyProperty::name) !=
         vertex_.properties.end())
    name += '_';
  return name;
}

PlyPlan Planner::finish(PlyHeader header, std::uint64_t count) {
  vertex_.count = count;
  header.elements = {std::move(vertex_)};
  plan_.header = std::move(header);
  return std::move(plan_);
}

}  // namespace

Result<PlyPlan> plan_ply(const std::string& path, const WriteOptions& options) {
  Planner planner(options);
  PlyHeader header;
  if (options.carry && options.carry->family == kPlyFormat.family) {
    const auto& head = options.carry->head;
    PSS_ASSIGN(header,
               parse_ply_header({reinterpret_cast<const char*>(head.data()), head.size()}, path));
    const auto vertex = header.find("vertex");
    if (!vertex)
      return Error{Fault::kBadInput, path + ": the carried PLY header has no element 'vertex'"};
    PSS_TRY(planner.follow(header.elements[*vertex], path));
  } else {
    planner.start_afresh();
  }
  planner.append_rest();
  return planner.finish(std::move(header), options.count);
}

}  // namespace pss
