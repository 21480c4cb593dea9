#pragma once
// A comparable text for the coordinate reference system that a LAS file names.

#include <cstddef>
#include <span>
#include <string>

#include "io/las_vlr.h"

namespace pss {

/// "EPSG:2994" where WKT or GeoTIFF keys name a horizontal code, else their own text, else empty.
///
/// WKT is preferred over GeoTIFF keys: where a file has both, they mean the same system.
std::string las_crs(std::span<const Vlr> vlrs, std::span<const std::byte> head,
                    std::span<const Vlr> evlrs, std::span<const std::byte> tail);

}  // namespace pss
