#include "stream/sort/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pss {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
/// Products of a multiple and a lattice position stay far within 64 bits.
constexpr double kLargestMultiple = 1 << 20;
constexpr double kLargestShift = 0x1p60;

/// `value` as an integer, where it is one to within `tolerance`.
std::optional<std::int64_t> integer(double value, double tolerance, double largest) {
  if (!(std::abs(value) <= largest)) return std::nullopt;
  const double nearest = std::rint(value);
  if (std::abs(value - nearest) > tolerance) return std::nullopt;
  return static_cast<std::int64_t>(nearest);
}

double length(const World3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

std::optional<GridMap> align(const Lattice& grid, const Lattice& lattice) {
  GridMap map;
  for (std::size_t a = 0; a < 3; ++a) {
    const double ratio = grid.scale[a] / lattice.scale[a];
    const double steps = (grid.origin[a] - lattice.origin[a]) / lattice.scale[a];
    const double magnitude = std::abs(grid.origin[a]) + std::abs(lattice.origin[a]);
    const double rounding = 4 * kEps * magnitude / lattice.scale[a] + 8 * kEps * std::abs(steps);
    const auto multiple = integer(ratio, 8 * kEps * ratio, kLargestMultiple);
    const auto shift = integer(steps, std::min(rounding, 0.01), kLargestShift);
    if (!multiple || *multiple < 1 || !shift) return std::nullopt;
    map.multiple[a] = *multiple;
    map.shift[a] = *shift;
  }
  return map;
}

Placement::Placement(const std::optional<Lattice>& grid, const Lattice& lattice)
    : grid_(grid), lattice_(lattice), map_(grid ? align(*grid, lattice) : std::nullopt) {}

Placed Placement::place(const PointBatch& batch, std::size_t i, Index3& out, double& move) const {
  move = 0;
  if (!grid_) return place_world(batch.world[i], out, move);
  if (map_) return place_exactly(batch.index[i], out);
  return place_rounded(batch.index[i], out, move);
}

Placed Placement::place_exactly(const Index3& index, Index3& out) const {
  if (!on_lattice(index)) return Placed::kOutside;
  for (std::size_t a = 0; a < 3; ++a) out[a] = map_->multiple[a] * index[a] + map_->shift[a];
  return on_lattice(out) ? Placed::kExact : Placed::kOutside;
}

Placed Placement::place_rounded(const Index3& index, Index3& out, double& move) const {
  World3 off{};
  for (std::size_t a = 0; a < 3; ++a) {
    // From the origin, not from zero, so that large offsets cost no digits.
    const double away =
        (grid_->origin[a] - lattice_.origin[a]) + grid_->scale[a] * static_cast<double>(index[a]);
    const double steps = away / lattice_.scale[a];
    if (!(std::abs(steps) < static_cast<double>(kLatticeMax))) return Placed::kOutside;
    out[a] = std::llrint(steps);
    off[a] = away - lattice_.scale[a] * static_cast<double>(out[a]);
  }
  move = length(off);
  return move == 0 ? Placed::kExact : Placed::kMoved;
}

Placed Placement::place_world(const World3& world, Index3& out, double& move) const {
  if (!std::ranges::all_of(world, [](double v) { return std::isfinite(v); }))
    return Placed::kNotFinite;
  if (!on_lattice(lattice_, world)) return Placed::kOutside;
  out = to_index(lattice_, world);
  const World3 back = to_world(lattice_, out);
  if (back == world) return Placed::kExact;
  move = length({world[0] - back[0], world[1] - back[1], world[2] - back[2]});
  return Placed::kMoved;
}

}  // namespace pss
