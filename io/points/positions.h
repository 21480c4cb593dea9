#pragma once
// The world position of a point in a batch, whether the batch holds integers or doubles.

#include <cstddef>
#include <optional>

#include "core/lattice.h"
#include "io/points/points.h"

namespace pss {

/// Requires: a grid where the batch has positions on one.
inline World3 world_position(const PointBatch& batch, const std::optional<Lattice>& grid,
                             std::size_t point) {
  return batch.index.empty() ? batch.world[point] : to_world(*grid, batch.index[point]);
}

}  // namespace pss
