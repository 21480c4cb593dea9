#include "io/formats/las/las_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <utility>

#include "io/formats/las/las_file.h"
#include "io/formats/las/las_format.h"
#include "io/formats/las/las_rebuild.h"
#include "io/points/integer_grid.h"

namespace pss {
namespace {

constexpr std::uint64_t kMostLegacyPoints = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kSystemId = 26;
constexpr std::size_t kSoftware = 58;

/// A head of our own: no clock, no machine, so that equal points give equal files.
LasHead fresh_head(const Schema& schema) {
  LasHead head;
  const LasTraits traits = las_traits_for(schema);
  head.header.point_format = las_format_with(traits);
  head.header.minor = std::max<std::uint8_t>(2, las_version_for(head.header.point_format));
  head.header.header_size = static_cast<std::uint16_t>(
      head.header.minor == 4 ? kLas14Header
                             : (head.header.minor == 3 ? kLas13Header : kLasSmallestHeader));
  head.header.point_offset = head.header.header_size;
  head.header.record_length = static_cast<std::uint16_t>(las_record_size(head.header.point_format));
  if (traits.extended) head.header.global_encoding = kLasWktBit;
  head.bytes.resize(head.header.header_size);
  std::memcpy(head.bytes.data(), "LASF", 4);
  std::memcpy(head.bytes.data() + kSystemId, "pss", 3);
  std::memcpy(head.bytes.data() + kSoftware, "pss", 3);
  return head;
}

bool carries_las(const WriteOptions& options) {
  return options.carry && options.carry->family == kLasFormat.family &&
         !options.carry->head.empty();
}

Result<LasHead> base_head(const std::string& path, WriteOptions& options, const Schema& schema) {
  if (!carries_las(options)) return fresh_head(schema);
  PSS_ASSIGN(LasHead head,
             parse_las_head(std::move(options.carry->head), path + " (carried header)",
                            std::numeric_limits<std::uint64_t>::max()));
  if (head.bytes.size() != head.header.point_offset)
    return Error{Fault::kBadInput,
                 fmt::format("{}: found a carried header of {} bytes, expected {}", path,
                             head.bytes.size(), head.header.point_offset)};
  return head;
}

/// What of a schema a head's row lacks, or holds only in part.
Schema lacking(const Schema& schema, const Schema& head) {
  const RowMapper mapper(schema, head);
  const auto named = [](const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  Schema result;
  for (const Dimension& d : schema.dimensions()) {
    if (!named(mapper.dropped(), d.name) && !named(mapper.narrowed(), d.name)) continue;
    Field field{d.name, d.type, d.count, d.scale, d.offset, {}};
    if (d.width != 0) field.bits = {{d.name, 0, d.width}};
    result.add(std::move(field));
  }
  return result;
}

/// The smallest field of its own for a bit field, the field itself otherwise.
Field as_extra(Field field) {
  if (field.bits.empty()) return field;
  const unsigned bits = field.bits[0].width;
  field.type = bits <= 8    ? Type::kUint8
               : bits <= 16 ? Type::kUint16
               : bits <= 32 ? Type::kUint32
                            : Type::kUint64;
  field.bits.clear();
  return field;
}

/// Makes `extra` hold what the standard fields cannot; whether that changed it.
bool extend(std::vector<ExtraField>& extra, const Schema& needs, const Schema& standard,
            std::vector<std::string>& notes) {
  bool changed = std::erase_if(extra, [&](const ExtraField& e) {
                   return standard.dimension(e.field.name).has_value();
                 }) > 0;
  for (const Field& need : needs.fields()) {
    if (standard.dimension(need.name)) continue;
    const Field field = as_extra(need);
    if (!can_describe(field)) {
      notes.push_back(fmt::format("{} is dropped: LAS has no attributes of {} x {}", field.name,
                                  field.count, type_name(field.type)));
      continue;
    }
    const auto there =
        std::ranges::find(extra, field.name, [](const ExtraField& e) { return e.field.name; });
    if (there != extra.end())
      *there = {field, std::nullopt};
    else
      extra.push_back({field, std::nullopt});
    changed = true;
  }
  return changed;
}

void note_crs(LasHead& head, std::vector<std::string>& notes) {
  const auto is_projection = [](std::uint16_t record) {
    return [record](const Vlr& vlr) { return vlr.is("LASF_Projection", record); };
  };
  if (std::ranges::any_of(head.vlrs(), is_projection(2112)))
    head.header.global_encoding |= kLasWktBit;
  else if (std::ranges::any_of(head.vlrs(), is_projection(34735)))
    notes.push_back(
        "the coordinate system stays in GeoTIFF keys, where the new point format "
        "expects WKT");
}

/// Changes the head so that its row has all the schema's dimensions; whether anything changed.
Result<bool> fit(LasHead& head, const WriteOptions& options, const Schema& schema,
                 const std::string& path, std::vector<std::string>& notes) {
  const Schema needs = lacking(schema, head.schema());
  const LasTraits had = las_traits(head.header.point_format);
  const LasTraits wanted = both(had, las_traits_for(needs));
  const std::uint8_t format =
      contains(had, wanted) ? head.header.point_format : las_format_with(wanted);
  const bool new_format = format != head.header.point_format;
  const Schema standard = las_standard_schema(format);
  const bool new_extra = extend(head.extra, needs, standard, notes);
  const bool dropped = drops_vlrs(head, notes);
  if (new_format) {
    notes.push_back(
        fmt::format("the point format becomes {}, from {}", format, head.header.point_format));
    head.header.point_format = format;
    if (wanted.extended && !had.extended) note_crs(head, notes);
  }
  std::uint8_t minor = new_format ? las_version_for(format) : std::uint8_t{0};
  if (options.count > kMostLegacyPoints) minor = 4;
  const bool new_version = minor > head.header.minor;
  raise_version(head, minor, notes);
  if (new_extra || dropped) PSS_TRY(rebuild_vlrs(head, new_extra, path));
  return new_format || new_extra || dropped || new_version;
}

Result<void> set_lengths(LasHead& head, const std::string& path) {
  const std::size_t record = kLasPositionSize + head.schema().row_size();
  if (record > std::numeric_limits<std::uint16_t>::max())
    return Error{
        Fault::kBadInput,
        fmt::format("{}: found {} bytes a point, expected at most 65535 in LAS", path, record)};
  if (head.bytes.size() > kLasLargestCarry)
    return Error{Fault::kBadInput, fmt::format("{}: found {} bytes of header and VLRs, expected at "
                                               "most {}",
                                               path, head.bytes.size(), kLasLargestCarry)};
  head.header.record_length = static_cast<std::uint16_t>(record);
  head.header.point_offset = static_cast<std::uint32_t>(head.bytes.size());
  return {};
}

std::string plain(std::string_view name) {
  std::string result;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

}  // namespace

Schema with_las_names(const Schema& schema) {
  const Schema standard = las_standard_schema(8);
  Schema result;
  for (Field field : schema.fields()) {
    for (const Dimension& d : standard.dimensions()) {
      if (!field.bits.empty() || plain(d.name) != plain(field.name)) continue;
      if (schema.dimension(d.name) || result.dimension(d.name)) continue;
      Field renamed = field;
      renamed.name = d.name;
      if (RowMapper(Schema({renamed}), standard).narrowed().empty()) field = std::move(renamed);
    }
    result.add(std::move(field));
  }
  return result;
}

Result<LasPlan> plan_las(const std::string& path, WriteOptions& options) {
  LasPlan plan;
  const Schema schema = with_las_names(options.schema);
  const bool carried = carries_las(options);
  PSS_ASSIGN(LasHead head, base_head(path, options, schema));
  const LasHeader before = head.header;
  PSS_ASSIGN(const bool changed, fit(head, options, schema, path, plan.notes));
  PSS_TRY(set_lengths(head, path));
  plan.keeps_layout = carried && !changed;
  plan.legacy_counts = carried && before.has_evlrs()
                           ? before.legacy_count != 0 || before.count == 0
                           : !las_traits(head.header.point_format).extended;
  std::optional<Lattice> carried_grid;
  if (carried) carried_grid = head.header.grid();
  const Lattice grid = choose_integer_grid(options, carried_grid, plan.notes);
  head.header.scale = grid.scale;
  head.header.offset = grid.origin;
  if (carried && head.header.has_evlrs()) plan.tail = std::move(options.carry->tail);
  plan.header = head.header;
  plan.schema = head.schema();
  plan.head = std::move(head.bytes);
  return plan;
}

}  // namespace pss
