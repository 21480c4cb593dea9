#pragma once
// What a selection made of the points of a tile, or of a scan.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "stream/store/note.h"

namespace pss {

/// What became of points. Excluded ones (classes 7 and 18, withheld) stay as they are.
struct SelectionCounts {
  std::uint64_t kept = 0;
  std::uint64_t low = 0;   ///< outliers that do not lie above their neighbours
  std::uint64_t high = 0;  ///< outliers that do
  std::uint64_t excluded = 0;

  std::uint64_t outliers() const { return low + high; }
  void add(const SelectionCounts& other);
  /// Of these bytes: another layout is another version.
  static constexpr std::uint32_t kVersion = 1;
  std::vector<std::byte> to_bytes() const;
  /// Bytes of another length give zeros.
  static SelectionCounts from_bytes(std::span<const std::byte> bytes);
  /// Of `store` or a tile of it. Errors: kBadInput where another version of pss wrote its note.
  static Result<SelectionCounts> from_note(const Note& note, const std::string& store);
};

}  // namespace pss
