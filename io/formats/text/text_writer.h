#pragma once
// Writes points as a text file: XYZ, CSV, TXT, ASC, PTS.

#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/writer.h"

namespace pss {

/// With the carried layout of a file of the same extension: its separator, comments, header line,
/// count line and columns in their order, new attributes behind them. Otherwise as the extension
/// asks: csv has commas and a header line, txt blanks and a header line, pts blanks and a count
/// line, others blanks alone.
///
/// Numbers are the shortest that read back as the same value. Positions on a grid of decimal scale
/// and origin are written as the decimals that they are.
Result<std::unique_ptr<Writer>> create_text(const std::string& path, const WriteOptions& options);

}  // namespace pss
