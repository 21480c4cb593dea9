#include "core/surface_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/projector.h"
#include "core/support.h"
#include "tests/support/cloud.h"

namespace pss::test {
namespace {

constexpr double kNoise = 0.3;  // in spacings
const Lattice kFine{{0.001, 0.001, 0.001}, {}};

/// The root of the mean square gated residual over the middle of a noisy plane of spacing 1.
double mean_residual(const Method& method, double h) {
  Random random(5);
  std::vector<World3> world;
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y)
      world.push_back({x + random.uniform(-0.25, 0.25), y + random.uniform(-0.25, 0.25),
                       kNoise * random.normal()});
  const std::vector<Index3> points = on_lattice_sorted(kFine, world);
  const Support support = support_of_h(h, method);
  const CellGrid grid(kFine, points, reach(support));
  Projector projector(grid, method);
  const SurfaceGate gate(method, support.radius / support.h);
  double sum = 0;
  int count = 0;
  for (const Index3& p : points) {
    if (p[0] < 15000 || p[0] > 45000 || p[1] < 15000 || p[1] > 45000) continue;
    const Query query{p};
    Projection projection;
    projector.project({&query, 1}, {&support, 1}, {&projection, 1});
    if (!moved(projection.status)) continue;
    sum += std::pow(gate.residual(projection), 2);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(SurfaceGate, GivesTheNoiseWhateverTheFitSpends) {
  for (const int degree : {1, 3})
    for (const double h : {2.0, 4.0}) {
      const double found = mean_residual({.op = MlsOperator::kFast, .degree = degree}, h);
      // Neighbours off the surface weigh less: 1/m = 1/v + 2/h^2.
      const double expected = std::sqrt(1 / (1 / (kNoise * kNoise) + 2 / (h * h)));
      EXPECT_NEAR(found, expected, 0.05 * expected) << "degree " << degree << ", h " << h;
    }
}

TEST(SurfaceGate, CorrectsNoMoreBelowTheFewestNeighbours) {
  const SurfaceGate gate({.op = MlsOperator::kFast, .degree = 3}, 3);
  Projection few;
  few.residual = 1;
  few.neighbours = 10;
  EXPECT_DOUBLE_EQ(gate.residual(few), 1 / std::sqrt(0.3));
  few.neighbours = 1000000;
  EXPECT_NEAR(gate.residual(few), 1, 1e-4);
}

}  // namespace
}  // namespace pss::test
