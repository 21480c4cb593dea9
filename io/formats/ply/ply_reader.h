#pragma once
// Opens PLY files for reading: ascii and binary of both byte orders.

#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/reader.h"

namespace pss {

/// Opens a PLY file. Positions are doubles (`world`), whatever the type of x, y and z.
///
/// Attributes are the other scalar properties of the vertices, with their own names and types;
/// lists and the other elements are skipped, which header().warnings says.
/// Errors: kFailed where it cannot be opened; kBadInput for a header that is damaged, has no
///         vertices with x, y and z, or promises more than the file's size can hold.
Result<std::unique_ptr<Reader>> open_ply(const std::string& path);

}  // namespace pss
