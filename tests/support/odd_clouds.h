#pragma once
// Clouds that are hardly or not at all a piece of a surface, for a width h of 1.

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/scan.h"

namespace pss::test {

struct OddCloud {
  std::string name;
  Scan scan;
  std::vector<Query> queries{};
};

using Points = std::vector<World3>;

/// A square grid of points on z = f(x, y).
template <class Function>
Points grid_on(const Function& f, double spacing = 0.25, double half = 4) {
  Points points;
  for (double x = -half; x <= half; x += spacing)
    for (double y = -half; y <= half; y += spacing) points.push_back({x, y, f(x, y)});
  return points;
}

inline Points flat(double height, double spacing = 0.25, double half = 4) {
  return grid_on([&](double, double) { return height; }, spacing, half);
}

inline Points joined(Points a, const Points& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The points with normals up, slightly turned, some pointing down and, if asked, some missing.
inline OddCloud odd_cloud(const std::string& name, const Points& points, double step = 0x1p-20,
                          const Index3& at = {0, 0, 0}, bool all_normals = true) {
  Random random(3);
  std::vector<SurfacePoint> samples;
  for (const World3& p : points) {
    const World3 n = normalized({0.2 * random.uniform(-1, 1), 0.2 * random.uniform(-1, 1), 1});
    const double keep = all_normals || samples.size() % 3 > 0 ? 1 : 0;
    samples.push_back({p, keep * (samples.size() % 5 > 0 ? n : -n)});
  }
  World3 origin;
  for (std::size_t a = 0; a < 3; ++a) origin[a] = -step * static_cast<double>(at[a]);
  OddCloud cloud{name, sorted_scan({{step, step, step}, origin}, samples), {}};
  cloud.scan.oriented = false;
  cloud.scan.spacing = 1;
  for (const World3& offset : {World3{0, 0, 0}, World3{0.011, -0.017, 0.019}})
    cloud.queries.push_back({at, offset});
  return cloud;
}

/// Where the origin goes, among points that are held to 2^-36.
inline Projection project_origin(const Points& points, const Support& support,
                                 const Method& method) {
  const OddCloud cloud = odd_cloud("", points, 0x1p-36);
  return ScanProjector(cloud.scan, support, method)(cloud.queries[0]);
}

inline std::vector<OddCloud> few_points() {
  const Points few{{0, 0, 0}, {0.5, 0, 0}, {0, 0.7, 0.1}, {-0.4, -0.3, 0}, {0.2, -0.6, 0.2}};
  std::vector<OddCloud> clouds;
  for (std::size_t n = 0; n <= few.size(); ++n)
    clouds.push_back(odd_cloud("first " + std::to_string(n),
                               {few.begin(), few.begin() + static_cast<std::ptrdiff_t>(n)}));
  return clouds;
}

inline std::vector<OddCloud> lines() {
  Points one, skew, two, three;
  for (int i = -60; i <= 60; ++i) {
    const double a = 0.0625 * i;
    one.push_back({a, 2 * a, -a});
    two.push_back({a, 0.3, 0.01 * (i % 3)});
    two.push_back({a, -0.4, 0});
    skew.push_back({a, 0, 0});
    skew.push_back({0, a, 0.5});
    for (const double y : {-0.5, 0.0, 0.6}) three.push_back({a, y, 0.02 * (i % 2)});
  }
  return {odd_cloud("one scan line", one), odd_cloud("two scan lines", two),
          odd_cloud("three scan lines", three), odd_cloud("skew lines", skew)};
}

/// Points among which no smallest eigenvalue stands out.
inline std::vector<OddCloud> ties() {
  Points cube, octahedron;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5}) cube.push_back({x, y, z});
  for (const double a : {-0.75, 0.75}) {
    octahedron.push_back({a, 0, 0});
    octahedron.push_back({0, a, 0});
    octahedron.push_back({0, 0, a});
  }
  const Points tetrahedron{
      {0.5, 0.5, 0.5}, {0.5, -0.5, -0.5}, {-0.5, 0.5, -0.5}, {-0.5, -0.5, 0.5}};
  return {odd_cloud("cube corners", cube), odd_cloud("tetrahedron", tetrahedron),
          odd_cloud("octahedron", octahedron)};
}

inline std::vector<OddCloud> sheets() {
  std::vector<OddCloud> clouds;
  for (const double apart : {0.5, 0.7, 0.75, 0.9, 1.0, 1.2, 1.5, 2.0, 2.25, 2.5, 3.0})
    clouds.push_back(
        odd_cloud("sheets apart by " + std::to_string(apart), joined(flat(0), flat(apart))));
  for (const double height : {0.4375, 0.499, 0.5, 0.501, 0.5625, 0.6875, 0.75, 0.8125, 0.9375, 1.0})
    clouds.push_back(odd_cloud("off a sheet by " + std::to_string(height), flat(height)));
  clouds.push_back(odd_cloud("plane", flat(0)));
  clouds.push_back(
      odd_cloud("hillside", grid_on([](double x, double y) { return x / 2 - y / 4; })));
  return clouds;
}

inline std::vector<OddCloud> bends() {
  const auto half_dense = joined(flat(0, 0.3), flat(0, 0.03, 1.2));
  return {odd_cloud("saddle", grid_on([](double x, double y) { return (x * x - y * y) / 2; })),
          odd_cloud("sharp saddle", grid_on([](double x, double y) { return 2 * x * y; })),
          odd_cloud("monkey saddle",
                    grid_on([](double x, double y) { return (x * x * x - 3 * x * y * y) / 4; })),
          odd_cloud("crease", grid_on([](double x, double) { return std::abs(x); })),
          odd_cloud("step", grid_on([](double x, double) { return x < 0 ? 0 : 0.8; })),
          odd_cloud("density jump", half_dense)};
}

inline std::vector<OddCloud> crowds() {
  Random random(12);
  Points volume;
  for (int i = 0; i < 300; ++i)
    volume.push_back({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)});
  const Points same(50, {0, 0, 0});
  const Points elsewhere(50, {0.3125, 0.1875, -0.125});
  return {odd_cloud("volume", volume),
          odd_cloud("identical", same),
          odd_cloud("identical elsewhere", elsewhere),
          odd_cloud("two places", joined(same, elsewhere)),
          odd_cloud("three places", joined(same, joined(elsewhere, {{0, 1, 0}}))),
          odd_cloud("only beyond the radius", {{3.1, 0, 0}, {0, 3.1, 0}, {-3.1, 0.5, 0}}),
          odd_cloud("hardly weighted",
                    {{2.99, 0, 0}, {0, 2.98, 0.3}, {-2.99, 0.1, 0}, {0, -2.97, 0.4}})};
}

/// 10^5 points in one ball, at one place and in a thick layer.
inline std::vector<OddCloud> multitudes() {
  Random random(13);
  Points layer;
  for (int i = 0; i < 100000; ++i)
    layer.push_back({random.uniform(-2, 2), random.uniform(-2, 2), 0.1 * random.normal()});
  return {odd_cloud("many at one place", Points(100000, {0.25, 0, 0})), odd_cloud("many", layer)};
}

/// Lattices that are coarse, and their ends.
inline std::vector<OddCloud> lattices() {
  Random random(8);
  const auto rough = [&](double, double) { return 0.1 * random.normal(); };
  const Points points = grid_on(rough);
  std::vector<OddCloud> clouds;
  for (const double step : {0.125, 0.5})  // 1/2 and 2 of the spacing
    clouds.push_back(odd_cloud("lattice of " + std::to_string(step), points, step));
  const std::int64_t inside = std::int64_t{6} << 20;  // steps that hold the cloud
  const std::int64_t low = kLatticeMin + inside;
  const std::int64_t high = kLatticeMax - inside;
  clouds.push_back(odd_cloud("lowest corner", points, 0x1p-20, {low, low, low}));
  clouds.push_back(odd_cloud("highest corner", points, 0x1p-20, {high, high, high}));
  clouds.push_back(odd_cloud("mixed corner", points, 0x1p-20, {low, high, low}));
  clouds.push_back(odd_cloud("some without normals", points, 0x1p-20, {0, 0, 0}, false));
  return clouds;
}

}  // namespace pss::test
