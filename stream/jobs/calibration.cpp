#include "stream/jobs/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/projector.h"
#include "core/support.h"
#include "stream/limit/stopwatch.h"

namespace pss {
namespace {

constexpr double kSeconds = 0.05;
constexpr std::size_t kQueries = 64;
constexpr double kMostNeighbours = 20000;
const Lattice kPatchLattice{{1e-6, 1e-6, 1e-6}, {0, 0, 0}};

/// Points of a slightly bent sheet in key order, and its innermost ones.
struct Patch {
  std::vector<Index3> points;
  std::vector<Normal> normals;
  std::vector<Query> queries;
};

/// `count` points with `density` of them in a unit of area: a sunflower, even at any count.
Patch sunflower(std::size_t count, double density) {
  Patch patch;
  for (std::size_t i = 0; i < count; ++i) {
    const double r = std::sqrt((static_cast<double>(i) + 0.5) / (density * std::numbers::pi));
    const double angle = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    const double x = r * std::cos(angle), y = r * std::sin(angle);
    patch.points.push_back(to_index(kPatchLattice, {x, y, 0.01 * x * y}));
  }
  for (std::size_t i = 0; i < kQueries; ++i) patch.queries.push_back({patch.points[i % count], {}});
  std::ranges::sort(patch.points,
                    [](const Index3& a, const Index3& b) { return encode_key(a) < encode_key(b); });
  patch.normals.assign(count, {0, 0, 1});
  return patch;
}

/// A patch whose innermost points have all their neighbours.
Patch patch_for(double neighbours, const Support& support) {
  const double density = neighbours / (std::numbers::pi * support.radius * support.radius);
  const double inner = std::sqrt(static_cast<double>(kQueries) / (density * std::numbers::pi));
  const double radius = reach(support) + inner;
  return sunflower(static_cast<std::size_t>(density * std::numbers::pi * radius * radius), density);
}

}  // namespace

double seconds_per_point(const Method& method, double neighbours) {
  const Support support = support_of_h(1, method);
  const Patch patch = patch_for(std::clamp(neighbours, 3.0, kMostNeighbours), support);
  const CellGrid grid(kPatchLattice, patch.points, reach(method.weight, support));
  Projector projector(grid, method, {patch.normals, true});
  std::array<Projection, kQueries> results;
  std::size_t points = 0;
  const Stopwatch watch;
  double elapsed = 0;
  do {
    projector.project(patch.queries, std::span(&support, 1), results);
    points += kQueries;
    elapsed = watch.seconds();
  } while (elapsed < kSeconds);
  return elapsed / static_cast<double>(points);
}

}  // namespace pss
