// k-nearest distances against FLANN, whose headers are slow to compile: nothing else is here.

#include <flann/flann.hpp>

#include <gtest/gtest.h>

#include <cmath>

#include "core/neighbours.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

TEST(KthDistance, AgreesWithFlann) {
  const Scan scan = scan_of(Torus{1, 0.4}, 0.02, 0.004);
  std::vector<World3> world;
  for (const Index3& p : scan.points) world.push_back(to_world(scan.lattice, p));
  const flann::Matrix<double> points(world.front().data(), world.size(), 3);
  flann::Index<flann::L2<double>> index(points, flann::KDTreeSingleIndexParams());
  index.buildIndex();
  const CellGrid grid(scan.lattice, scan.points, 0.06);

  for (std::size_t i = 0; i < world.size(); i += 97)
    for (const int k : {1, 16, 200}) {
      std::vector<int> found(static_cast<std::size_t>(k) + 1);
      std::vector<double> squares(found.size());
      flann::Matrix<int> indices(found.data(), 1, found.size());
      flann::Matrix<double> distances(squares.data(), 1, squares.size());
      index.knnSearch(flann::Matrix<double>(world[i].data(), 1, 3), indices, distances,
                      found.size(), flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
      const double expected = std::sqrt(squares.back());  // the nearest is the point itself
      EXPECT_NEAR(grid.kth_distance(scan.points[i], k, 10).value(), expected, 1e-14);
    }
}

}  // namespace
}  // namespace pss::test
