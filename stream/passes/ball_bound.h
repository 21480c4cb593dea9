#pragma once
// How many points one ball may hold: what the memory for a query's neighbours depends on.

#include <cstdint>
#include <functional>
#include <span>

#include "core/lattice.h"
#include "core/neighbours.h"

namespace pss {

/// A number, at least `enough`, that no ball about one of the points `own` exceeds; reach(i) is the
/// radius of the i-th.
///
/// Counts the grid's cells that balls touch: on a surface up to ten times what balls hold. Points
/// are counted in groups, and in ever smaller ones, down to copies of one position, where that may
/// be more than has been found yet.
///
/// Requires: `own` in an order that keeps neighbours together; radii >= 0, below 0 for no ball.
/// Cost:     one search for cells a group of 256 points, some more about the fullest balls;
///           parallel.
std::uint64_t ball_bound(const CellGrid& grid, std::span<const Index3> own,
                         const std::function<double(std::size_t)>& reach, std::uint64_t enough);

}  // namespace pss
