#pragma once
// Finds out how a text file of points is laid out, from its first lines.

#include <cstdint>
#include <optional>

#include "core/result.h"
#include "io/file/line_source.h"
#include "io/formats/text/text_layout.h"

namespace pss {

struct TextStart {
  TextLayout layout;
  std::optional<std::uint64_t> count;  ///< points promised by a count line
  LinePlace points;                    ///< where the first point is
};

/// Reads from the start of `lines`; where no line holds a point, the layout may be the default.
///
/// Names come from a header line (also behind "#" or "//") that has x, y and z in any case, or
/// Easting, Northing, Elevation. Without one: 4 columns end in Intensity, 6 in Red Green Blue, 7
/// in both, where the colours of the first lines are whole and 0 to 255; other columns are c4,
/// c5, ...
/// Errors: kBadInput with the line where it is no text file of points.
Result<TextStart> detect_text(LineSource& lines);

}  // namespace pss
