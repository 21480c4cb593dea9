#pragma once
// The memory that control groups leave to this process.

#include <cstdint>
#include <string_view>

namespace pss {

/// The least memory limit of the process's control group and of those it lies in; the largest
/// number where there is none.
///
/// Shape: `membership` is the content of /proc/self/cgroup; `root` is where the groups are mounted.
std::uint64_t cgroup_memory_limit(std::string_view membership,
                                  std::string_view root = "/sys/fs/cgroup");

}  // namespace pss
