#include "io/formats/las/las_schema.h"

#include <array>

namespace pss {
namespace {

constexpr std::array<LasTraits, 11> kTraits{{
    // extended, GPS time, colour, infrared, wave
    {false, false, false, false, false},  // 0
    {false, true, false, false, false},   // 1
    {false, false, true, false, false},   // 2
    {false, true, true, false, false},    // 3
    {false, true, false, false, true},    // 4
    {false, true, true, false, true},     // 5
    {true, true, false, false, false},    // 6
    {true, true, true, false, false},     // 7
    {true, true, true, true, false},      // 8
    {true, true, false, false, true},     // 9
    {true, true, true, true, true},       // 10
}};

constexpr const char* kWaveNames[] = {"WavePacketIndex",
                                      "WavePacketOffset",
                                      "WavePacketSize",
                                      "WaveReturnLocation",
                                      "WaveX",
                                      "WaveY",
                                      "WaveZ"};

void add_legacy_core(Schema& schema) {
  schema.add({"Intensity", Type::kUint16, 1, 1, 0, {}});
  schema.add({"ReturnFlags",
              Type::kUint8,
              1,
              1,
              0,
              {{"ReturnNumber", 0, 3},
               {"NumberOfReturns", 3, 3},
               {"ScanDirectionFlag", 6, 1},
               {"EdgeOfFlightLine", 7, 1}}});
  schema.add(
      {"ClassFlags",
       Type::kUint8,
       1,
       1,
       0,
       {{"Classification", 0, 5}, {"Synthetic", 5, 1}, {"KeyPoint", 6, 1}, {"Withheld", 7, 1}}});
  schema.add({"ScanAngleRank", Type::kInt8, 1, 1, 0, {}});
  schema.add({"UserData", Type::kUint8, 1, 1, 0, {}});
  schema.add({"PointSourceId", Type::kUint16, 1, 1, 0, {}});
}

void add_extended_core(Schema& schema) {
  schema.add({"Intensity", Type::kUint16, 1, 1, 0, {}});
  schema.add(
      {"Returns", Type::kUint8, 1, 1, 0, {{"ReturnNumber", 0, 4}, {"NumberOfReturns", 4, 4}}});
  schema.add({"Flags",
              Type::kUint8,
              1,
              1,
              0,
              {{"Synthetic", 0, 1},
               {"KeyPoint", 1, 1},
               {"Withheld", 2, 1},
               {"Overlap", 3, 1},
               {"ScannerChannel", 4, 2},
               {"ScanDirectionFlag", 6, 1},
               {"EdgeOfFlightLine", 7, 1}}});
  schema.add({"Classification", Type::kUint8, 1, 1, 0, {}});
  schema.add({"UserData", Type::kUint8, 1, 1, 0, {}});
  schema.add({"ScanAngleRank", Type::kInt16, 1, 0.006, 0, {}});  // degrees
  schema.add({"PointSourceId", Type::kUint16, 1, 1, 0, {}});
}

void add_wave_packet(Schema& schema) {
  constexpr Type kTypes[] = {Type::kUint8,   Type::kUint64,  Type::kUint32, Type::kFloat32,
                             Type::kFloat32, Type::kFloat32, Type::kFloat32};
  for (std::size_t i = 0; i < std::size(kTypes); ++i)
    schema.add({kWaveNames[i], kTypes[i], 1, 1, 0, {}});
}

/// Whether values of a dimension may need more than so many bits.
bool wider_than(const Schema& schema, const char* name, unsigned bits) {
  const std::optional<Dimension> d = schema.dimension(name);
  if (!d) return false;
  return (d->width != 0 ? d->width : 8 * size_of(d->type)) > bits;
}

bool has(const Schema& schema, const char* name) { return schema.dimension(name).has_value(); }

}  // namespace

bool contains(const LasTraits& a, const LasTraits& b) {
  return a.extended >= b.extended && a.gps_time >= b.gps_time && a.colour >= b.colour &&
         a.infrared >= b.infrared && a.wave >= b.wave;
}

LasTraits both(const LasTraits& a, const LasTraits& b) {
  return {a.extended || b.extended, a.gps_time || b.gps_time, a.colour || b.colour,
          a.infrared || b.infrared, a.wave || b.wave};
}

LasTraits las_traits(std::uint8_t point_format) { return kTraits[point_format]; }

std::uint8_t las_format_with(const LasTraits& traits) {
  std::uint8_t format = 0;
  while (format < kLasLastFormat && !contains(kTraits[format], traits)) ++format;
  return format;
}

LasTraits las_traits_for(const Schema& schema) {
  LasTraits traits;
  traits.gps_time = has(schema, "GpsTime");
  traits.colour = has(schema, "Red") || has(schema, "Green") || has(schema, "Blue");
  traits.infrared = has(schema, "Infrared");
  for (const char* name : kWaveNames) traits.wave = traits.wave || has(schema, name);
  traits.extended =
      traits.infrared || has(schema, "Overlap") || has(schema, "ScannerChannel") ||
      wider_than(schema, "ReturnNumber", 3) || wider_than(schema, "NumberOfReturns", 3) ||
      wider_than(schema, "Classification", 5) || wider_than(schema, "ScanAngleRank", 8);
  return traits;
}

std::uint8_t las_version_for(std::uint8_t point_format) {
  return point_format >= 6 ? 4 : point_format >= 4 ? 3 : point_format >= 2 ? 2 : 0;
}

std::size_t las_record_size(std::uint8_t point_format) {
  return kLasPositionSize + las_standard_schema(point_format).row_size();
}

Schema las_standard_schema(std::uint8_t point_format) {
  const LasTraits traits = las_traits(point_format);
  Schema schema;
  if (traits.extended)
    add_extended_core(schema);
  else
    add_legacy_core(schema);
  if (traits.gps_time) schema.add({"GpsTime", Type::kFloat64, 1, 1, 0, {}});
  if (traits.colour)
    for (const char* name : {"Red", "Green", "Blue"})
      schema.add({name, Type::kUint16, 1, 1, 0, {}});
  if (traits.infrared) schema.add({"Infrared", Type::kUint16, 1, 1, 0, {}});
  if (traits.wave) add_wave_packet(schema);
  return schema;
}

}  // namespace pss
