#pragma once
// The point formats 0 to 10 of LAS: the record's bytes after x, y, z as a row of named fields.

#include <cstddef>
#include <cstdint>

#include "io/points/schema.h"

namespace pss {

inline constexpr std::uint8_t kLasLastFormat = 10;
inline constexpr std::size_t kLasPositionSize = 12;  ///< x, y, z as int32

/// What a point format has beyond the fields that all have.
struct LasTraits {
  bool extended = false;  ///< formats 6 to 10: wider returns and classes, always with GPS time
  bool gps_time = false;
  bool colour = false;
  bool infrared = false;
  bool wave = false;
};

LasTraits las_traits(std::uint8_t point_format);
/// The least point format that has all of these.
std::uint8_t las_format_with(const LasTraits& traits);
/// What a schema asks of a point format: by names, and by the bits of returns and classes.
LasTraits las_traits_for(const Schema& schema);
/// Whether `a` has all that `b` has, and both together.
bool contains(const LasTraits& a, const LasTraits& b);
LasTraits both(const LasTraits& a, const LasTraits& b);
/// The first minor version of LAS 1 that has the point format.
std::uint8_t las_version_for(std::uint8_t point_format);

/// Bytes of the record without extra bytes. Requires: point_format <= kLasLastFormat.
std::size_t las_record_size(std::uint8_t point_format);

/// The fields of the record after x, y, z, without extra bytes.
Schema las_standard_schema(std::uint8_t point_format);

}  // namespace pss
