#pragma once
// How many points one ball may hold: what the memory for a query's neighbours depends on.

#include <cstdint>
#include <span>

#include "core/lattice.h"

namespace pss {

/// A number that no ball of this radius about one of the points exceeds.
///
/// Counts whole cells: on a surface up to ten times what balls hold. Where that is at most
/// `enough`, the first number that is found serves, however coarse.
///
/// Requires: points sorted by key; radius >= 0.
/// Cost:     one pass over the points; beyond `enough` 27 searches a cell, in parallel.
std::uint64_t ball_bound(const Lattice& lattice, std::span<const Index3> points, double radius,
                         std::uint64_t enough);

/// What that holds at most: where every point has a cell of its own.
std::uint64_t ball_bound_bytes(std::uint64_t points);

}  // namespace pss
