#pragma once
// Points that come in order, whether from memory or from runs on the disk.

#include <cstddef>
#include <span>

#include "core/morton.h"
#include "core/result.h"

namespace pss {

class SortedStream {
 public:
  virtual ~SortedStream() = default;

  /// Fills the front of `keys` and `rows` with following points, and says how many they are; none
  /// means the end.
  ///
  /// Shape: room for a point at least; `rows` a row for each of `keys`.
  virtual Result<std::size_t> read(std::span<Key> keys, std::span<std::byte> rows) = 0;
};

}  // namespace pss
