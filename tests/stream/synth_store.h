#pragma once
// Stores of known surfaces with noise, and how far projections of them are from the truth.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/projector.h"
#include "core/shapes.h"
#include "core/vec3.h"
#include "io/synth/synth.h"
#include "stream/widths/noise.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/cloud.h"

namespace pss::test {

/// Points on a lattice, in key order.
struct Points {
  Lattice lattice;
  std::vector<Index3> positions;
};

/// Even samples of a surface, moved along the normal by `noise` spacings (standard deviation).
inline Points synth_points(const Surface& surface, std::uint64_t count, double noise) {
  SynthOptions options;
  options.surface = surface;
  options.points = count;
  options.noise = noise;
  options.seed = 11;
  const auto reader = expect_value(SynthReader::create(options));
  Points points{grid(options), {}};
  PointBatch batch;
  do {
    expect_ok(reader->read(count, batch));
    points.positions.insert(points.positions.end(), batch.index.begin(), batch.index.end());
  } while (batch.size() > 0);
  sort_by_key(points.positions);
  return points;
}

/// Tiles of `tile` points each, in the points' order.
inline Store store_of(const Points& points, const std::string& path, std::size_t tile = 100000) {
  const Cloud cloud{points.positions, {}};
  StoreHeader header;
  header.lattice = points.lattice;
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  for (std::size_t begin = 0; begin < points.positions.size(); begin += tile)
    expect_ok(append_tile(writer, header.schema, cloud, begin,
                          std::min(begin + tile, points.positions.size())));
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

inline SpacingSample sample_of(const Store& store) {
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;
  return expect_value(sample_spacing(store, budget, monitor));
}

inline Noise noise_of(const Store& store, const Method& method = {}) {
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;
  return expect_value(measure_noise(store, sample_of(store), method, budget, monitor));
}

/// The rms distance to the surface after the projection of about a thousand points.
inline double error_at(const Points& points, const Surface& surface, double h) {
  const Support support{h, 3 * h};
  const CellGrid grid(points.lattice, points.positions, reach(support));
  pss::Projector projector(grid, Method{});
  std::vector<Query> queries;
  for (std::size_t i = 0; i < points.positions.size(); i += points.positions.size() / 1000)
    queries.push_back({points.positions[i], {}});
  std::vector<Projection> found(queries.size());
  projector.project(queries, {&support, 1}, found);
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (found[i].status != Status::kOk || found[i].boundary > 0.3) continue;
    const World3 place = to_world(points.lattice, queries[i].position) + found[i].displacement;
    const double distance = foot_of(surface, place).distance;
    sum += distance * distance;
    ++count;
  }
  return std::sqrt(sum / count);
}

}  // namespace pss::test
