#pragma once
// Changes the head of a LAS file: a higher version, other VLRs.

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/formats/las/las_file.h"

namespace pss {

/// Brings the head to LAS 1.`minor` where it is below; bytes beyond the standard header stay.
void raise_version(LasHead& head, std::uint8_t minor, std::vector<std::string>& notes);

/// Whether some VLRs would lie in a new file; says which.
bool drops_vlrs(const LasHead& head, std::vector<std::string>& notes);

/// Writes the VLRs anew: without those that are dropped, with new extra-bytes descriptors.
///
/// Errors: kBadInput where there are more extra fields than LAS can describe.
Result<void> rebuild_vlrs(LasHead& head, bool new_extra, const std::string& path);

}  // namespace pss
