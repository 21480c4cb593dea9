#include "stream/widths/sheets.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/symmetric3.h"
#include "core/vec3.h"

namespace pss {
namespace {

constexpr double kPlaneRadius = 2.25;  ///< units: about sixteen points of a surface
constexpr double kCylinderRadius = 2;
constexpr double kGap = 1;
constexpr double kShare = 0.25;  ///< of the first sheet's points
constexpr std::size_t kFewest = 3;

/// The direction in which the points vary least.
World3 normal_of(const Offsets& points) {
  World3 mean{0, 0, 0};
  for (std::size_t i = 0; i < points.size(); ++i)
    mean = mean + World3{points.x[i], points.y[i], points.z[i]};
  mean = 1 / static_cast<double>(points.size()) * mean;
  Symmetric3 c;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const World3 p = World3{points.x[i], points.y[i], points.z[i]} - mean;
    c.xx += p[0] * p[0];
    c.xy += p[0] * p[1];
    c.xz += p[0] * p[2];
    c.yy += p[1] * p[1];
    c.yz += p[1] * p[2];
    c.zz += p[2] * p[2];
  }
  return eigen_decomposition(c).vectors[0];
}

/// How far from the plane the points of the cylinder about it lie, ascending.
std::vector<double> heights(const Offsets& points, const World3& normal, double radius) {
  std::vector<double> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const World3 p{points.x[i], points.y[i], points.z[i]};
    const double height = dot(p, normal);
    if (dot(p, p) - height * height < radius * radius) found.push_back(std::abs(height));
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace

std::optional<double> other_sheet(const CellGrid& grid, const Index3& position, double unit,
                                  double farthest) {
  Offsets points;
  grid.gather({position, {}}, kPlaneRadius * unit, points);
  if (points.size() < kFewest) return std::nullopt;
  const World3 normal = normal_of(points);
  grid.gather({position, {}}, (farthest + kCylinderRadius) * unit, points);
  const std::vector<double> found = heights(points, normal, kCylinderRadius * unit);
  std::size_t own = 1;
  while (own < found.size() && found[own] - found[own - 1] < kGap * unit) ++own;
  const auto needed =
      std::max(kFewest, static_cast<std::size_t>(kShare * static_cast<double>(own)));
  if (found.size() < own + needed) return std::nullopt;
  return found[own + needed - 1] / unit;
}

}  // namespace pss
