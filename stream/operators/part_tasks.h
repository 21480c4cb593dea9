#pragma once
// Cuts the own points of a part into pieces of work.

#include <cstddef>
#include <vector>

#include "stream/passes/part.h"

namespace pss {

/// Consecutive own points of one block.
struct Slice {
  std::size_t block = 0;
  std::size_t first = 0;  ///< own point of the part
  std::size_t count = 0;  ///< at most Operator::kTaskPoints
};

/// All own points, in order. Tiles and parts end at blocks: the slices do not depend on them.
std::vector<Slice> slices_of(const Part& part);

/// Ranges of slices for one task each, such that duplicates of a position are not divided.
std::vector<PointRange> tasks_of(const Part& part, const std::vector<Slice>& slices);

}  // namespace pss
