#include "io/points/integer_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pss {
namespace {

constexpr double kMin = -2147483648.0;
constexpr double kMax = 2147483647.0;
/// The part of the range to either side that a chosen grid fills at most: it leaves room for the
/// offset's rounding, and for points that move a little.
constexpr double kUsableSteps = 2e9;
constexpr int kFinestExponent = -18;
/// Of grids for points that may move. Finer ones would hold them too, but files that are written
/// from stores have had this limit from the beginning.
constexpr int kFinestExponentWithRoom = -12;
constexpr int kCoarsestExponent = 300;
constexpr double kPointExtent = 1e-6;

/// The double nearest to 10^exponent, by one exactly rounded operation.
double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10;  // exact up to 10^22
  return exponent < 0 ? 1 / power : power;
}

/// The finest power of ten, from 10^finest on, that holds `half_side` to either side.
double finest_scale(double half_side, int finest = kFinestExponent) {
  int exponent = finest;
  while (exponent < kCoarsestExponent && half_side / power_of_ten(exponent) > kUsableSteps)
    ++exponent;
  return power_of_ten(exponent);
}

double half_side(const WorldBox& bounds, std::size_t axis) {
  const double half = bounds.max[axis] / 2 - bounds.min[axis] / 2;
  const double largest = std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
  return half > 0 ? half : largest * kPointExtent;
}

/// The multiple of 10^5 steps nearest the centre: round to read, and still near enough.
double round_offset(const WorldBox& bounds, std::size_t axis, double scale) {
  const double centre = bounds.min[axis] / 2 + bounds.max[axis] / 2;
  const double unit = scale * 1e5;
  const double whole = unit < 1 ? 1 / std::round(1 / unit) : std::round(unit);
  return std::nearbyint(centre / whole) * whole;
}

bool usable(const WorldBox& bounds) {
  for (std::size_t a = 0; a < 3; ++a)
    if (!std::isfinite(bounds.min[a]) || !std::isfinite(bounds.max[a])) return false;
  return !bounds.empty();
}

/// The options' own scale and offset over `grid`; an offset that does not fit moves to the centre.
Lattice with_options(Lattice grid, const WriteOptions& options) {
  if (options.offset) grid.origin = *options.offset;
  if (!options.scale) return grid;
  grid.scale = *options.scale;
  const bool centre = !options.offset && options.bounds && usable(*options.bounds) &&
                      !integer_grid_holds(grid, *options.bounds);
  for (std::size_t a = 0; centre && a < 3; ++a)
    grid.origin[a] = round_offset(*options.bounds, a, grid.scale[a]);
  return grid;
}

/// A grid about the centre of the bounds: of `scale` where that holds them, otherwise coarser.
Lattice holding_grid(const WorldBox& bounds, const World3& scale) {
  Lattice grid{scale, {}};
  for (std::size_t a = 0; a < 3; ++a) grid.origin[a] = round_offset(bounds, a, scale[a]);
  if (integer_grid_holds(grid, bounds)) return grid;
  double coarsest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    coarsest = std::max(coarsest, finest_scale(half_side(bounds, a)));
  for (std::size_t a = 0; a < 3; ++a) grid.origin[a] = round_offset(bounds, a, coarsest);
  grid.scale = {coarsest, coarsest, coarsest};
  return grid;
}

}  // namespace

bool integer_grid_holds(const Lattice& grid, const WorldBox& bounds) {
  for (std::size_t a = 0; a < 3; ++a)
    for (const double place : {bounds.min[a], bounds.max[a]}) {
      const double steps = std::nearbyint((place - grid.origin[a]) / grid.scale[a]);
      if (!(steps >= kMin && steps <= kMax)) return false;  // also NaN
    }
  return true;
}

Result<void> check_integer_grid(const std::string& path, const Lattice& grid,
                                const WorldBox& bounds, const WorldBox& all) {
  if (bounds.empty() || integer_grid_holds(grid, bounds)) return {};
  const Lattice better = holding_grid(all, grid.scale);
  const World3& origin = better.origin;
  const std::string scale =
      better.scale == grid.scale ? "" : fmt::format("--scale={} ", better.scale[0]);
  return Error{
      Fault::kBadInput,
      fmt::format("{}: positions from ({}, {}, {}) to ({}, {}, {}) do not fit into 32-bit integers "
                  "with scale "
                  "({}, {}, {}) and offset ({}, {}, {}), which hold 2^31 steps to either side; use "
                  "{}--offset={},{},{}",
                  path, bounds.min[0], bounds.min[1], bounds.min[2], bounds.max[0], bounds.max[1],
                  bounds.max[2], grid.scale[0], grid.scale[1], grid.scale[2], grid.origin[0],
                  grid.origin[1], grid.origin[2], scale, origin[0], origin[1], origin[2])};
}

Lattice integer_grid_for(const WorldBox& bounds) {
  Lattice grid;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.scale[a] = finest_scale(half_side(bounds, a));
    grid.origin[a] = round_offset(bounds, a, grid.scale[a]);
  }
  return grid;
}

Lattice integer_grid_with_room(const WorldBox& bounds, double margin) {
  Lattice grid;
  double half = 0;
  for (std::size_t a = 0; a < 3 && !bounds.empty(); ++a) {
    grid.origin[a] = std::nearbyint(bounds.min[a] / 2 + bounds.max[a] / 2);
    half = std::max({half, bounds.max[a] - grid.origin[a], grid.origin[a] - bounds.min[a]});
  }
  const double scale = finest_scale(half + margin, kFinestExponentWithRoom);
  grid.scale = {scale, scale, scale};
  return grid;
}

Lattice choose_integer_grid(const WriteOptions& options, const std::optional<Lattice>& carried,
                            std::vector<std::string>& notes) {
  const bool bounded = options.bounds && usable(*options.bounds);
  // With a scale or offset of its own, only what the user named can be wrong, and write() says so.
  const bool free = !options.scale && !options.offset;
  for (const std::optional<Lattice>& candidate : {carried, options.grid}) {
    if (!candidate) continue;
    if (!free || !bounded || options.same_points || integer_grid_holds(*candidate, *options.bounds))
      return with_options(*candidate, options);
  }
  if (!bounded) return with_options({{0.001, 0.001, 0.001}, {0, 0, 0}}, options);
  const Lattice chosen = integer_grid_for(*options.bounds);
  if (carried)
    notes.push_back(
        fmt::format("the points do not fit the scale and offset of the input's header, "
                    "so scale {} {} {} is used",
                    chosen.scale[0], chosen.scale[1], chosen.scale[2]));
  return with_options(chosen, options);
}

}  // namespace pss
