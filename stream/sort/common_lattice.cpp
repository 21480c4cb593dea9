#include "stream/sort/common_lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pss {

Lattice common_grid(std::span<const Lattice> grids) {
  Lattice lattice = grids[0];
  for (const Lattice& grid : grids) {
    for (std::size_t a = 0; a < 3; ++a)
      lattice.scale[a] = std::min(lattice.scale[a], grid.scale[a]);
    lattice.origin = std::min(lattice.origin, grid.origin);
  }
  return lattice;
}

Lattice lattice_with_step(const WorldBox& bounds, const World3& step) {
  Lattice lattice{step, {}};
  if (bounds.empty()) return lattice;
  for (std::size_t a = 0; a < 3; ++a) {
    const double centre = bounds.min[a] / 2 + bounds.max[a] / 2;
    lattice.origin[a] = std::nearbyint(centre / step[a]) * step[a];
  }
  return lattice;
}

Result<void> check_fits(const std::string& path, const WorldBox& bounds, const Lattice& lattice) {
  if (bounds.empty()) return {};
  if (on_lattice(lattice, bounds.min) && on_lattice(lattice, bounds.max)) return {};
  double needed = 0;
  for (std::size_t a = 0; a < 3; ++a)
    needed = std::max({needed, std::abs(bounds.min[a] - lattice.origin[a]),
                       std::abs(bounds.max[a] - lattice.origin[a])});
  return Error{
      Fault::kBadInput,
      fmt::format("{}: from ({}, {}, {}) to ({}, {}, {}) is more than {} bits of steps of "
                  "({}, {}, {}) from ({}, {}, {}); use --scale {:.2g} or coarser",
                  path, bounds.min[0], bounds.min[1], bounds.min[2], bounds.max[0], bounds.max[1],
                  bounds.max[2], kLatticeBits, lattice.scale[0], lattice.scale[1], lattice.scale[2],
                  lattice.origin[0], lattice.origin[1], lattice.origin[2],
                  1.05 * needed / static_cast<double>(kLatticeMax - 1))};
}

Result<void> check_step(const World3& step) {
  if (std::ranges::all_of(step, [](double s) { return std::isfinite(s) && s > 0; })) return {};
  return Error{Fault::kUsage, fmt::format("--scale ({}, {}, {}): a step is a number above zero",
                                          step[0], step[1], step[2])};
}

}  // namespace pss
