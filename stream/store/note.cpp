#include "stream/store/note.h"

#include <fmt/format.h>

namespace pss {

Result<std::span<const std::byte>> bytes_of(const Note& note, std::uint32_t expected,
                                            const std::string& store) {
  const bool empty = note.version == 0 && note.bytes.empty();
  if (empty || note.version == expected) return std::span(note.bytes);
  return Error{Fault::kBadInput,
               fmt::format("{}: a note of version {} found, this program reads version {}; build "
                           "the store again, or use --restart where it is a job's",
                           store, note.version, expected)};
}

}  // namespace pss
