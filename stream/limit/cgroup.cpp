#include "stream/limit/cgroup.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace pss {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The number in a file; no limit where the file is missing or says "max".
std::uint64_t limit_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t bytes = 0;
  return file >> bytes ? bytes : kNoLimit;
}

/// The least limit of a group and of all above it. A group that is not there, as seen from within a
/// container, is that at the top of the mount.
std::uint64_t least_limit(const std::string& mount, std::string group, const char* file) {
  std::uint64_t least = kNoLimit;
  for (;;) {
    least = std::min(least, limit_in(fmt::format("{}{}/{}", mount, group, file)));
    const std::size_t last = group.rfind('/');
    if (last == std::string::npos) return least;
    group.resize(last);
  }
}

bool lists(const std::string& controllers, const char* name) {
  std::istringstream words(controllers);
  for (std::string word; std::getline(words, word, ',');)
    if (word == name) return true;
  return false;
}

}  // namespace

std::uint64_t cgroup_memory_limit(std::string_view membership, std::string_view root) {
  std::istringstream lines{std::string(membership)};
  std::uint64_t least = kNoLimit;
  // "ID:CONTROLLERS:/GROUP"; version 2 names no controllers.
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty())
      least = std::min(least, least_limit(std::string(root), group, "memory.max"));
    else if (lists(controllers, "memory"))
      least = std::min(least,
                       least_limit(fmt::format("{}/memory", root), group, "memory.limit_in_bytes"));
  }
  return least;
}

}  // namespace pss
