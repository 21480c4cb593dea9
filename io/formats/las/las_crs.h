#pragma once
// A comparable text for the coordinate reference system that a LAS file names.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "io/formats/las/las_vlr.h"

namespace pss {

inline constexpr std::uint16_t kWktRecord = 2112;  ///< of user id "LASF_Projection"

/// What two WKT records are compared by; unreadable WKT is compared as it stands.
std::string crs_of_wkt(std::span<const std::byte> bytes);

/// "EPSG:2994" where WKT or GeoTIFF keys name a horizontal code, else their own text, else empty.
///
/// WKT is preferred over GeoTIFF keys: where a file has both, they mean the same system.
/// `tail_crs` is that of a WKT behind the points, where there is one.
std::string las_crs(const VlrRange& vlrs, std::span<const std::byte> head,
                    const std::optional<std::string>& tail_crs);

}  // namespace pss
