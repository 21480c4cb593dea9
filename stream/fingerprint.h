#pragma once
// Tells whether a file is still the one that was read: size, time, and a hash of both ends.

#include <string>

#include "core/result.h"
#include "stream/manifest.h"

namespace pss {

/// The record of a file as it is now. `path` is kept as given.
Result<InputRecord> fingerprint(const std::string& path);

}  // namespace pss
