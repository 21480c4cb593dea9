#pragma once
// How much a stage reads and writes, by the kernel's count; 0 where it counts nothing.

#include <cstdint>

namespace pss {

/// Bytes of system calls, whether they reached a disk or a cache.
struct Transfer {
  std::uint64_t read = 0;
  std::uint64_t written = 0;
};

/// What this process has read and written since it began.
Transfer transferred();

/// What it has read and written since `before`.
Transfer transferred_since(const Transfer& before);

}  // namespace pss
