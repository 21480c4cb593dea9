#pragma once
// What is said of a tile, or of a whole store, beside its points.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace pss {

/// Bytes in a form that their writer chose: an operator's statistics of a tile, or their sum.
struct Note {
  std::uint32_t version = 0;  ///< of that form; 0 where there is nothing to say
  std::vector<std::byte> bytes;

  bool operator==(const Note&) const = default;
};

/// The bytes of a note for a reader who knows one version of it; none where nothing was said.
///
/// Errors: kBadInput, with the store and both versions, where the note is of another.
Result<std::span<const std::byte>> bytes_of(const Note& note, std::uint32_t expected,
                                            const std::string& store);

}  // namespace pss
