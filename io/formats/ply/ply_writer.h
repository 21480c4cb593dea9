#pragma once
// Writes points as a PLY file, in the manner of the file they came from where that was PLY.

#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/writer.h"

namespace pss {

/// With a carried PLY header: its encoding, comments, property order and types; what the schema
/// lacks is dropped, what the header lacks is appended. Without one: binary little-endian, double
/// x y z, one property a dimension (bit fields apart, arrays as name_0, name_1, ...).
///
/// NormalX, NormalY and NormalZ are written as nx, ny and nz and replace properties so named.
/// Coordinates are rounded to the carried type; a whole or finite value that it cannot hold is
/// kBadInput.
Result<std::unique_ptr<Writer>> create_ply(const std::string& path, const WriteOptions& options);

}  // namespace pss
