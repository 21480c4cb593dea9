#pragma once
// The table of all formats. What the rest of the program knows of a format, it knows from its row.

#include <array>
#include <string>
#include <string_view>

#include "io/formats/las/las_format.h"
#include "io/formats/ply/ply_format.h"
#include "io/formats/text/text_format.h"
#include "io/points/format.h"

namespace pss {

/// A file is of the first format that it certainly is, else of the first that is possible.
inline constexpr std::array kFormats{&kLasFormat, &kPlyFormat, &kTextFormat};

/// The row of this name; null where there is none.
const Format* find_format(std::string_view name);
/// The row with the extension of this path, in any case; null where there is none.
const Format* format_by_extension(const std::string& path);

// For messages and --help.
/// The formats that can be read: "LAS, PLY or text (xyz, txt)".
std::string readable_formats();
/// The extensions that can be written: "las, ply or xyz", with this `conjunction`.
std::string writable_extensions(std::string_view conjunction = " or ");
/// The formats with an integer grid: "LAS".
std::string gridded_formats(std::string_view conjunction = " or ");

}  // namespace pss
