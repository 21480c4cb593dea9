#pragma once
// Points that come in order, whether from memory or from runs on the disk.

#include <cstddef>

#include "core/result.h"
#include "stream/keyed_rows.h"

namespace pss {

class SortedStream {
 public:
  virtual ~SortedStream() = default;

  /// Replaces `out` by at most `max` following points; none means the end.
  virtual Result<void> read(std::size_t max, KeyedRows& out) = 0;
};

}  // namespace pss
