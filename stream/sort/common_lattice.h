#pragma once
// Chooses the one lattice that the positions of all inputs lie on.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/lattice.h"
#include "core/result.h"

namespace pss {

/// Of the grids of files: the finest scale, the least offset. One grid alone is kept.
///
/// Shape: at least one grid.
Lattice common_grid(std::span<const Lattice> grids);

/// For bounds in the world and a step by hand: the multiples of the step nearest the centre.
Lattice lattice_with_step(const WorldBox& bounds, const World3& step);

/// Errors: kBadInput, with numbers and the --scale that would do, where `bounds` leave the lattice.
Result<void> check_fits(const std::string& path, const WorldBox& bounds, const Lattice& lattice);

/// Errors: kUsage where a step is not a positive number.
Result<void> check_step(const World3& step);

}  // namespace pss
