#pragma once
// How many points one ball may hold: what the memory for a query's neighbours depends on.

#include <cstdint>
#include <functional>
#include <span>

#include "core/lattice.h"
#include "core/neighbours.h"

namespace pss {

/// A number that no ball about one of the points `own` exceeds; reach(i) is the radius of the i-th.
///
/// Counts the grid's cells that balls touch: on a surface up to ten times what balls hold. Points
/// are counted in groups, and in ever smaller ones where that is more than `enough`, down to
/// copies of one position.
///
/// Requires: `own` in an order that keeps neighbours together; radii >= 0, below 0 for no ball.
/// Cost:     one search for cells a group of 256 points, up to one a point beyond `enough`;
///           parallel.
std::uint64_t ball_bound(const CellGrid& grid, std::span<const Index3> own,
                         const std::function<double(std::size_t)>& reach, std::uint64_t enough);

/// What counting for so many points holds.
std::uint64_t ball_bound_bytes(std::uint64_t points);

}  // namespace pss
