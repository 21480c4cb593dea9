#pragma once
// Synthetic scans for tests: options, and all records or places that they give.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "io/synth/synth.h"

namespace pss::test {

inline PointBatch read_range(const SynthOptions& options, std::uint64_t first, std::size_t count) {
  auto reader = SynthReader::create(options);
  EXPECT_TRUE(reader) << reader.error().message;
  PointBatch batch;
  EXPECT_TRUE((*reader)->seek(first));
  EXPECT_TRUE((*reader)->read(count, batch));
  return batch;
}

inline PointBatch read_all(const SynthOptions& options) {
  return read_range(options, 0, static_cast<std::size_t>(options.points));
}

/// Positions relative to the offset.
inline std::vector<World3> places(const SynthOptions& options) {
  Lattice lattice = grid(options);
  lattice.origin = {0, 0, 0};
  std::vector<World3> all;
  for (const Index3& index : read_all(options).index) all.push_back(to_world(lattice, index));
  return all;
}

inline SynthOptions options_for(const Surface& surface, std::uint64_t points) {
  SynthOptions options;
  options.surface = surface;
  options.points = points;
  return options;
}

/// Every option at once.
inline SynthOptions rich_options() {
  SynthOptions options = options_for(Torus{}, 20'011);
  options.scans = 3;
  options.noise = 0.2;
  options.corner_density = 5;
  options.density_gradient = 2;
  options.offset = {500000, 4649776, 100};
  options.truth = true;
  return options;
}

}  // namespace pss::test
