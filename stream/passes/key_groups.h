#pragma once
// Cuts points in key order into groups that lie close together, whatever their density.

#include <cstddef>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/neighbours.h"

namespace pss {

/// Ranges of at most `most` points that cover all of them, cut where the order leaps farthest.
///
/// Each lies within a cell of its own, so that its box holds few points besides; copies of one
/// position are not cut.
///
/// Requires: positions roughly in key order, as a store has them; most >= 1.
/// Cost:     O(n log n).
std::vector<PointRange> key_groups(std::span<const Index3> positions, std::size_t most);

}  // namespace pss
