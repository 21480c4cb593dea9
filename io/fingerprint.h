#pragma once
// Tells whether a file is still the one that was read: size, time, and a hash of both ends.

#include <cstdint>
#include <string>

#include "core/result.h"

namespace pss {

/// A file that points came from, as far as it tells whether it is still the same.
struct InputRecord {
  std::string path;
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;
  std::uint64_t content_hash = 0;  ///< of its first and last 64 KiB

  bool operator==(const InputRecord&) const = default;
};

/// The record of a file as it is now. `path` is kept as given.
Result<InputRecord> fingerprint(const std::string& path);

}  // namespace pss
