#include "io/fingerprint.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "io/file.h"
#include "io/hash.h"

namespace pss {
namespace {

constexpr std::uint64_t kEndBytes = 64 * 1024;

}  // namespace

Result<InputRecord> fingerprint(const std::string& path) {
  PSS_ASSIGN(const File file, File::open(path));
  PSS_ASSIGN(const FileState state, file.state());
  InputRecord record;
  record.path = path;
  record.size = state.size;
  record.modified_ns = state.modified_ns;
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
