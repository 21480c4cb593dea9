// A program outside the project: the installed headers and libraries are all that it has.
#include <vector>

#include "core/mls_surface.h"
#include "stream/jobs/smooth.h"
#include "stream/limit/memory.h"

int main() {
  std::vector<pss::World3> points;
  for (int i = 0; i < 100; ++i) points.push_back({0.1 * (i % 10), 0.1 * (i / 10), 2});
  const auto surface = pss::MlsSurface::create(points);
  if (!surface) return 1;
  const std::vector<pss::World3> queries{{0.5, 0.5, 2.05}};
  const pss::Projected projected = surface->project(queries);
  const bool carried = projected.results[0].status == pss::Status::kOk &&
                       projected.positions[0][2] > 1.999 && projected.positions[0][2] < 2.001;
  return carried && pss::machine_memory() > 0 ? 0 : 1;
}
