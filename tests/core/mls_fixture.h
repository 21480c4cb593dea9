#pragma once
// Points for tests of the library's surface: a noisy torus, a small square.

#include <vector>

#include "core/mls_surface.h"
#include "core/shapes.h"
#include "core/vec3.h"
#include "tests/support/cloud.h"

namespace pss::test {

/// Random points near a torus, `spacing` apart on average.
inline std::vector<World3> noisy_torus(double spacing, double noise, std::uint64_t seed = 11) {
  const Torus torus;
  Random random(seed);
  std::vector<World3> points(static_cast<std::size_t>(area(torus) / (spacing * spacing)));
  for (World3& p : points) {
    const SurfacePoint on = surface_point(torus, random.uniform(), random.uniform());
    p = on.position + noise * random.normal() * on.normal;
  }
  return points;
}

/// A flat square of 5 x 5 points in z = 0, from 0 to 1.
inline std::vector<World3> small_square() {
  std::vector<World3> points;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) points.push_back({0.25 * i, 0.25 * j, 0});
  return points;
}

inline MlsSurface surface_over(const std::vector<World3>& points, const MlsOptions& options = {}) {
  return MlsSurface::create(points, options).value();
}

}  // namespace pss::test
