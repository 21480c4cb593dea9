#pragma once
// A comparable text for the coordinate reference system that a LAS file names.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "io/las_vlr.h"

namespace pss {

/// "EPSG:2994" where WKT or GeoTIFF keys name a horizontal code, else their own text, else empty.
///
/// WKT is preferred over GeoTIFF keys: where a file has both, they mean the same system.
std::string las_crs(std::span<const Vlr> vlrs, std::span<const std::byte> head,
                    std::span<const Vlr> evlrs, std::span<const std::byte> tail);

/// The EPSG code of the horizontal part of a WKT text, as "EPSG:n"; empty where it names none.
std::string epsg_of_wkt(std::string_view wkt);

}  // namespace pss
