#pragma once
// Where a sorted sequence of points is cut: the leaves of the octree with at most n points each.

#include <cstddef>

#include "core/morton.h"

namespace pss {

/// The level of the largest octant that holds the point `first` and neither of the others.
///
/// `before` is the last point of the tile before (null: there is none), `beyond` the point that
/// would be one too many (null: fewer than that many are left). That octant is the leaf of `first`:
/// it holds few enough points, and its parent holds too many.
///
/// Where more points share one position than a tile may hold, no octant is small enough: tiles one
/// after the other then have the position itself, level 42, as their cell.
int leaf_level(const Key& first, const Key* before, const Key* beyond);

}  // namespace pss
