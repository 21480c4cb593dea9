#pragma once
// A caller's points as the grid wants them: on a lattice, in key order, with the way back.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/projector.h"
#include "core/result.h"

namespace pss {

/// A direction as a cloud's normal: of length one; zero for what has no direction.
Normal unit_normal(const World3& direction);
inline Normal unit_normal(const Normal& direction) {
  return unit_normal(World3{direction[0], direction[1], direction[2]});
}

struct SortedCloud {
  Lattice lattice;
  std::vector<Index3> points;        ///< in key order; those at one position by their normals
  std::vector<Normal> normals;       ///< in the same order, unit or zero; empty for none
  std::vector<std::uint32_t> order;  ///< points[i] is the caller's point order[i]
};

/// Rounds `points` to `lattice`, or to lattice_for() their bounds, and sorts them.
///
/// Shape:  `normals` is empty, or has one for each point: of any length, zeros for none.
/// Errors: kBadInput, naming the first such point, where one is not finite or not on the lattice,
///         or a normal is not finite; where one lies so far away that lattice_for() is too coarse
///         for the spacing of the others; where there are 2^32 - 1 points or more.
/// Cost:   O(n); 48 bytes a point beside the result.
Result<SortedCloud> sort_cloud(std::span<const World3> points, std::span<const Normal> normals = {},
                               const std::optional<Lattice>& lattice = std::nullopt);

/// The mean distance between points on a surface: spacing_over() a sample, as jobs measure it.
///
/// Empty where there are fewer than 17 distinct positions. It depends on neither the order of the
/// caller's points nor on how many share a position.
///
/// Cost: O(n), and some thousand searches for neighbours.
std::optional<double> spacing_of(const SortedCloud& cloud);

}  // namespace pss
