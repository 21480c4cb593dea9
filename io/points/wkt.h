#pragma once
// Well-known text of coordinate reference systems, as far as two of them can be compared.

#include <string>
#include <string_view>

namespace pss {

/// "EPSG:2994" for the horizontal part of a WKT text, where it names its code.
///
/// Otherwise what defines the system: datum, ellipsoid, projection, parameters and units, without
/// the free names and the spelling in which writers differ. Empty for a text that is no WKT.
/// Cost: linear in the text; nesting deeper than 32 is no WKT.
std::string comparable_wkt(std::string_view wkt);

}  // namespace pss
