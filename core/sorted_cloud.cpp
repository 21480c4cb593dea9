#include "core/sorted_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/key_sort.h"
#include "core/morton.h"
#include "core/neighbours.h"
#include "core/position_sample.h"
#include "core/spacing.h"
#include "core/vec3.h"
#include "core/world_sample.h"

namespace pss {
namespace {

constexpr std::size_t kMostPoints = std::numeric_limits<std::uint32_t>::max() - 1;
/// Beyond it squares of lengths overflow.
constexpr double kLargestCoordinate = 1e150;

Error bad(std::string message) { return {Fault::kBadInput, std::move(message)}; }

bool is_usable(const World3& p) {
  return std::ranges::all_of(p, [](double c) { return std::abs(c) <= kLargestCoordinate; });
}

bool is_finite(const Normal& n) {
  return std::ranges::all_of(n, [](float c) { return std::isfinite(c); });
}

Result<void> check_points(std::span<const World3> points) {
  if (points.size() > kMostPoints)
    return bad(fmt::format("found {} points, expected at most {}", points.size(), kMostPoints));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_usable(points[i]))
      return bad(fmt::format("point {}: found ({}, {}, {}), expected finite coordinates up to {:g}",
                             i, points[i][0], points[i][1], points[i][2], kLargestCoordinate));
  return {};
}

Result<void> check_normals(std::span<const Normal> normals, std::size_t points) {
  if (!normals.empty() && normals.size() != points)
    return bad(fmt::format("found {} normals for {} points", normals.size(), points));
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (!is_finite(normals[i]))
      return bad(fmt::format("normal {}: found ({}, {}, {}), expected numbers, zeros for none", i,
                             normals[i][0], normals[i][1], normals[i][2]));
  return {};
}

/// Errors: a point that `lattice` does not hold.
Result<void> check_on_lattice(std::span<const World3> points, const Lattice& lattice) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!on_lattice(lattice, points[i]))
      return bad(fmt::format(
          "point {}: ({}, {}, {}) is more than {} bits of steps of ({}, {}, {}) from the lattice's "
          "origin; expected a coarser lattice",
          i, points[i][0], points[i][1], points[i][2], kLatticeBits, lattice.scale[0],
          lattice.scale[1], lattice.scale[2]));
  return {};
}

Lattice lattice_of(std::span<const World3> points) {
  WorldBox bounds;
  for (const World3& p : points) bounds.add(p);
  return lattice_for(bounds);
}

/// The point farthest from `middle` along any axis.
std::size_t farthest_from(const World3& middle, std::span<const World3> points) {
  const auto distance = [&](const World3& p) {
    return std::max(
        {std::abs(p[0] - middle[0]), std::abs(p[1] - middle[1]), std::abs(p[2] - middle[2])});
  };
  return static_cast<std::size_t>(std::ranges::max_element(points, {}, distance) - points.begin());
}

/// Errors: a point so far away that the lattice chosen for all makes many of the others one.
Result<void> check_step(std::span<const World3> points, const Lattice& lattice) {
  WorldSample sample;
  for (const World3& p : points) sample.add(p);
  const double step = lattice.scale[0];
  PSS_ASSIGN(const double spacing, spacing_beside(step, sample, [&](SpacingMeter& meter) {
               meter.add(points);
               return Result<void>();
             }));
  if (!too_coarse(step, spacing)) return {};
  const std::size_t far = farthest_from(sample.middle(), points);
  return bad(fmt::format(
      "point {}: ({}, {}, {}) is so far from the others that the lattice would have steps of "
      "{:.3g}, more than a hundredth of their spacing of {:.3g}; leave such points out, or give a "
      "lattice",
      far, points[far][0], points[far][1], points[far][2], step, spacing));
}

}  // namespace

Normal unit_normal(const World3& direction) {
  const double length_sq = dot(direction, direction);
  if (!std::isnormal(length_sq)) return {0, 0, 0};
  const double length = std::sqrt(length_sq);
  return {static_cast<float>(direction[0] / length), static_cast<float>(direction[1] / length),
          static_cast<float>(direction[2] / length)};
}

Result<SortedCloud> sort_cloud(std::span<const World3> points, std::span<const Normal> normals,
                               const std::optional<Lattice>& lattice) {
  PSS_TRY(check_points(points));
  PSS_TRY(check_normals(normals, points.size()));
  SortedCloud cloud;
  cloud.lattice = lattice ? *lattice : lattice_of(points);
  PSS_TRY(check_on_lattice(points, cloud.lattice));
  if (!lattice) PSS_TRY(check_step(points, cloud.lattice));

  std::vector<Key> keys(points.size());
  std::ranges::transform(points, keys.begin(),
                         [&](const World3& p) { return encode_key(to_index(cloud.lattice, p)); });
  std::vector<KeyEntry> entries(points.size()), scratch(points.size());
  const TieBreak by_normal = [&](std::uint32_t a, std::uint32_t b) {
    return normals[a] != normals[b] ? normals[a] < normals[b] : a < b;
  };
  // Only a monitor that stops makes it fail.
  static_cast<void>(sort_keys(keys, entries, scratch, normals.empty() ? nullptr : by_normal));
  cloud.points.reserve(points.size());
  cloud.order.reserve(points.size());
  cloud.normals.reserve(normals.size());
  for (const KeyEntry& entry : entries) {
    cloud.points.push_back(decode_key(keys[entry.index]));
    cloud.order.push_back(entry.index);
    if (!normals.empty()) cloud.normals.push_back(unit_normal(normals[entry.index]));
  }
  return cloud;
}

std::optional<double> spacing_of(const SortedCloud& cloud) {
  PositionSample sample(kSpacingSample);
  for (const Index3& position : cloud.points) sample.add(position);
  const CellGrid grid(cloud.lattice, cloud.points, std::numeric_limits<double>::min());
  const NearestOf nearest = [&](const Index3& position,
                                std::size_t count) -> Result<std::vector<Neighbour>> {
    return grid.nearest(position, count);
  };
  // Only a search that fails makes it fail.
  const SpacingSample measured = spacing_over(cloud.lattice, sample.positions(), nearest).value();
  if (!measured.spacing) return std::nullopt;
  return measured.spacing->spacing;
}

}  // namespace pss
