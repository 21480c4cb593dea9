// Whether a program that uses pss::core in memory gets what tiles on disk give.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/mls_surface.h"
#include "stream/operators/project.h"
#include "tests/stream/pass_fixture.h"
#include "tests/support/cloud.h"
#include "tests/support/methods.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::Cloud;
using test::expect_ok;
using test::expect_value;

const Lattice kLattice{{0.001, 0.001, 0.001}, {500000, 4649776, 100}};
constexpr double kH = 1.4;
constexpr double kResultStep = 0.001 / 256;  // of the refined lattice that results stand on

/// A noisy wave over a square of 40 x 40, spacing about 0.7, in key order.
Cloud wave() {
  test::Random random(5);
  std::vector<World3> world;
  for (int i = 0; i < 3200; ++i) {
    const double x = random.uniform(0, 40), y = random.uniform(0, 40);
    world.push_back({500000 + x, 4649776 + y, 100 + std::sin(x / 8) * 3 + 0.1 * random.normal()});
  }
  return {test::on_lattice_sorted(kLattice, world), {}};
}

/// The points as a store of three tiles.
Store store_of(const Cloud& cloud, const std::string& path) {
  StoreHeader header;
  header.lattice = kLattice;
  header.grid = kLattice;
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  std::size_t begin = 0;
  for (const std::size_t end : {std::size_t{700}, std::size_t{2500}, cloud.positions.size()})
    expect_ok(test::append_tile(writer, header.schema, cloud, std::exchange(begin, end), end));
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

Store projected(const Source& source, const ProjectParameters& parameters,
                const std::string& path) {
  const ProjectOperator op = expect_value(ProjectOperator::create(source, parameters));
  return test::run(source, op, path);
}

/// Where the engine puts the points, in key order.
std::vector<Index3> places_by_tiles(const Cloud& cloud, const ProjectParameters& parameters) {
  test::TemporaryDirectory folder;
  const Store points = store_of(cloud, folder / "points.pss");
  if (!needs_normals(parameters.method.op))
    return expect_value(test::read_all(projected(points, parameters, folder / "result.pss")))
        .positions;
  ProjectParameters first_pass = parameters;
  first_pass.method = normals_method(parameters.method);
  first_pass.only_normals = true;
  const Store normals = projected(points, first_pass, folder / "normals.pss");
  Source with_normals(points);
  test::expect_ok(with_normals.join(normals));
  return expect_value(test::read_all(projected(with_normals, parameters, folder / "result.pss")))
      .positions;
}

/// What the library makes of the same points, shuffled and as doubles; again in key order.
std::vector<Index3> places_by_library(const Cloud& cloud, MlsOptions options) {
  std::vector<std::size_t> order(cloud.positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  test::Random random(6);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
  std::vector<World3> points;
  for (const std::size_t i : order) points.push_back(to_world(kLattice, cloud.positions[i]));

  options.lattice = kLattice;
  const MlsSurface surface = expect_value(MlsSurface::create(points, options));
  const std::vector<Projection> results = surface.project_points();
  std::vector<Index3> places(cloud.positions.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a)
      places[order[k]][a] = 256 * cloud.positions[order[k]][a] +
                            std::llrint(results[k].displacement[a] / kResultStep);
  return places;
}

class LibraryAndTiles : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(
    Methods, LibraryAndTiles,
    testing::Values(Method{}, Method{MlsOperator::kApss}, Method{MlsOperator::kRimls},
                    Method{MlsOperator::kApss, WeightKind::kWendland, Precision::kSingle},
                    Method{MlsOperator::kFast, WeightKind::kPcl},
                    Method{MlsOperator::kFast, WeightKind::kGaussian, Precision::kSingle},
                    Method{MlsOperator::kLevin, WeightKind::kWendland, Precision::kDouble, 4}),
    test::method_name);

TEST_P(LibraryAndTiles, GiveTheSamePlacesForTheSameWidth) {
  const Cloud cloud = wave();
  ProjectParameters parameters;
  parameters.method = GetParam();
  parameters.support = {kH, 3 * kH};
  MlsOptions options;
  options.method = GetParam();
  options.h = kH;
  options.radius = 3 * kH;
  EXPECT_EQ(places_by_library(cloud, options), places_by_tiles(cloud, parameters));
}

TEST_P(LibraryAndTiles, GiveTheSamePlacesWhereEachPointHasItsWidth) {
  const Cloud cloud = wave();
  ProjectParameters parameters;
  parameters.method = GetParam();
  parameters.nearest = 30;
  parameters.cap = 7;
  parameters.first_guess = 2;
  MlsOptions options;
  options.method = GetParam();
  options.knn = 30;
  options.radius = 7;
  EXPECT_EQ(places_by_library(cloud, options), places_by_tiles(cloud, parameters));
}

}  // namespace
}  // namespace pss
