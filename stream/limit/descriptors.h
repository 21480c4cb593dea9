#pragma once
// How many files a process may have open.

#include <cstddef>

namespace pss {

/// The limit on descriptors of this process (RLIMIT_NOFILE); the largest number where it has none.
std::size_t descriptor_limit();

}  // namespace pss
