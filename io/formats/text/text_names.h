#pragma once
// The names of a text file's columns: from its header line, or by convention.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pss {

/// Names as a header line gives them, without quotes.
std::vector<std::string> names_in(std::string_view header, char separator);

/// The columns that are x, y and z: so named in any case, or Easting, Northing, Elevation or
/// Height; units in brackets are fine.
std::optional<std::array<std::size_t, 3>> find_axes(const std::vector<std::string>& names);

/// Gives a name to columns without one, and another to those whose name is taken.
void make_distinct(std::vector<std::string>& names);

/// x, y, z and what usually follows them. `colours`: the last three columns look like colours.
///
/// Requires: `count` is at least 3.
std::vector<std::string> conventional_names(std::size_t count, bool colours);

}  // namespace pss
