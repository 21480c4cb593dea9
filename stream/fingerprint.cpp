#include "stream/fingerprint.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "io/file.h"
#include "stream/hash.h"

namespace pss {
namespace {

constexpr std::uint64_t kEndBytes = 64 * 1024;

}  // namespace

Result<InputRecord> fingerprint(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return Error{Fault::kFailed, fmt::format("{}: {}", path, std::strerror(errno))};
  InputRecord record;
  record.path = path;
  record.size = static_cast<std::uint64_t>(status.st_size);
  record.modified_ns = status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec;
  PSS_ASSIGN(const File file, File::open(path));
  std::vector<std::byte> ends(2 * kEndBytes);
  const std::uint64_t last = record.size - std::min(record.size, kEndBytes);
  PSS_ASSIGN(const std::size_t head,
             file.read_some(0, std::span(ends).first(static_cast<std::size_t>(kEndBytes))));
  PSS_ASSIGN(
      const std::size_t tail,
      file.read_some(last, std::span(ends).subspan(head, static_cast<std::size_t>(kEndBytes))));
  record.content_hash = hash64(std::span(ends).first(head + tail));
  return record;
}

}  // namespace pss
