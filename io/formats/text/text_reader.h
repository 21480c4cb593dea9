#pragma once
// Opens text files of points for reading: XYZ, CSV, TXT, ASC, PTS.

#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/reader.h"

namespace pss {

/// Opens a text file whose lines are points: x, y, z and other numbers.
///
/// Positions and attributes are doubles, with the names of the header line or of the convention
/// (see io/formats/text/text_detect.h). The number of points is known only where a count line
/// promises it. A file without any point, an empty one too, is an empty cloud.
/// Errors: kFailed where it cannot be opened; kBadInput with the line where it is no such text.
Result<std::unique_ptr<Reader>> open_text(const std::string& path);

}  // namespace pss
