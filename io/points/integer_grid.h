#pragma once
// Decimal grids whose coordinates are 32-bit integers, as LAS has them: what they hold, and which
// one to choose.

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/points/writer.h"

namespace pss {

/// Whether every position within the bounds has a 32-bit integer on the grid.
bool integer_grid_holds(const Lattice& grid, const WorldBox& bounds);

/// Errors: kBadInput where `bounds`, of the points of `path`, do not fit the grid, with the
/// --offset that would hold them, and the --scale where no offset would do alone. `all` are the
/// bounds of everything that the grid is for.
Result<void> check_integer_grid(const std::string& path, const Lattice& grid,
                                const WorldBox& bounds, const WorldBox& all);

/// So many steps a side of the bounds has at least on a grid whose scale is chosen for them.
inline constexpr double kLeastGridSteps = 4e8;

/// The finest power of ten for which the bounds fit, an axis each, and a round offset near their
/// centre.
///
/// Bounds without extent get the scale of a box of 10^-6 of their largest coordinate.
Lattice integer_grid_for(const WorldBox& bounds);

/// The finest power of ten for which the bounds fit, one for all axes, and the offset of whole
/// units nearest their centre: what points of a store get, which may move by `margin` to any side.
///
/// Empty bounds have their centre at zero.
Lattice integer_grid_with_room(const WorldBox& bounds, double margin);

/// The grid of a file to be written: scale and offset of the options, else of `carried`, else of
/// options.grid, else chosen for options.bounds; what the bounds do not fit is passed over.
Lattice choose_integer_grid(const WriteOptions& options, const std::optional<Lattice>& carried,
                            std::vector<std::string>& notes);

}  // namespace pss
