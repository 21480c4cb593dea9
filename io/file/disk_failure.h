#pragma once
// The sentence for a call to the disk that failed.

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <system_error>

#include "core/result.h"
#include "io/file/disk.h"

namespace pss::disk {

/// "PATH: cannot WHAT: the system's words". Requires: `outcome` is an errno, negated.
inline Error failure(std::string_view what, const std::string& path, Outcome outcome) {
  const std::error_code code(static_cast<int>(-outcome), std::generic_category());
  return {Fault::kFailed, fmt::format("{}: cannot {}: {}", path, what, code.message())};
}

}  // namespace pss::disk
