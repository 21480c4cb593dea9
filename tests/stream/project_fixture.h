#pragma once
// A noisy wave as a store cut anywhere, and operators run over it.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "stream/operators/project.h"
#include "tests/stream/pass_fixture.h"
#include "tests/support/cloud.h"
#include "tests/support/test_data.h"

namespace pss::test {

inline constexpr std::size_t kPoints = 7000;
inline const Lattice kLattice{{0.001, 0.001, 0.001}, {500000, 4649776, 100}};

inline Schema class_schema() { return Schema({{"Classification", Type::kUint8, 1, 1, 0, {}}}); }

/// A noisy wave over a square of 60 x 60, spacing about 0.7; one point in fifty is noise class.
inline Cloud wave(std::uint64_t seed) {
  Random random(seed);
  std::vector<World3> world;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double x = random.uniform(0, 60), y = random.uniform(0, 60);
    world.push_back({500000 + x, 4649776 + y, 100 + std::sin(x / 8) * 3 + 0.1 * random.normal()});
  }
  Cloud cloud{on_lattice_sorted(kLattice, world), std::vector<std::byte>(kPoints)};
  for (std::size_t i = 0; i < kPoints; i += 50) cloud.rows[i] = std::byte{7};
  return cloud;
}

/// The cloud as a store whose tiles end at `cuts`.
inline Store store_of(const Cloud& cloud, const std::string& path, std::vector<std::size_t> cuts) {
  StoreHeader header;
  header.lattice = kLattice;
  header.grid = kLattice;
  header.schema = class_schema();
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  std::size_t begin = 0;
  cuts.push_back(cloud.positions.size());
  for (const std::size_t end : cuts) {
    expect_ok(append_tile(writer, header.schema, cloud, begin, end));
    begin = end;
  }
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

inline ProjectParameters fixed_support() {
  ProjectParameters parameters;
  parameters.support = {1.4, 4.2};
  parameters.outputs = kAllOutputs;
  return parameters;
}

inline ProjectParameters nearest_support() {
  ProjectParameters parameters;
  parameters.nearest = 24;
  parameters.cap = 7;
  parameters.first_guess = 1;  // too small on purpose: parts are loaded again
  parameters.outputs = kAllOutputs;
  return parameters;
}

inline Cloud project(const Source& source, const ProjectParameters& parameters,
                     const std::string& path, std::uint64_t limit = 512 * kMiB) {
  const ProjectOperator op = expect_value(ProjectOperator::create(source, parameters));
  return expect_value(read_all(run(source, op, path, limit)));
}

inline void expect_equal(const Cloud& found, const Cloud& expected) {
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.rows, expected.rows);
}

}  // namespace pss::test
