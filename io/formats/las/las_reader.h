#pragma once
// Opens uncompressed LAS files, versions 1.0 to 1.5, for reading.

#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/reader.h"

namespace pss {

/// Opens a LAS file. Positions are its integers, rows are its records' bytes after x, y, z.
///
/// Errors: kFailed where it cannot be opened; kBadInput for LAZ, a damaged header, or a file with
///         fewer points than its header promises.
Result<std::unique_ptr<Reader>> open_las(const std::string& path);
/// The same; what is held of the head is as open_reader_holding() says.
Result<std::unique_ptr<Reader>> open_las_holding(HeadBytes bytes, const std::string& path);

}  // namespace pss
