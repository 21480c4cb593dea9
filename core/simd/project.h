#pragma once
// The door to the kernels: a batch of queries, carried out by the widest vectors of the machine.

#include <cstdint>
#include <span>
#include <vector>

#include "core/projector.h"
#include "core/simd/workspace.h"

namespace pss::simd {

/// What a batch computes with.
struct Batch {
  const CellGrid& grid;
  const CloudNormals& normals;
  Method method;
  std::span<const Query> queries;
  std::span<const Support> supports;  ///< one for all queries, or one for each
  std::span<Projection> results;

  const Support& support(std::size_t i) const { return supports[supports.size() == 1 ? 0 : i]; }
};

/// Candidates of one lane before they are transposed: coordinates, and normals where they count.
template <class T>
struct LaneRow {
  Buffer<T> x, y, z, nx, ny, nz;
  std::size_t count = 0;
  std::uint32_t query = 0;
};

/// All that a thread needs again for the next batch.
struct Workspace {
  static constexpr std::size_t kMostLanes = 16;

  std::vector<PointRange> ranges;
  Buffer<std::int32_t> narrow_x, narrow_y, narrow_z;  // candidates of a run, in steps
  Buffer<double> wide_x, wide_y, wide_z;
  Buffer<float> normal_x, normal_y, normal_z;
  LaneRow<float> single[kMostLanes];
  LaneRow<double> twice[kMostLanes];
  Buffer<std::byte> balls, stage;
};

/// Projects queries[which[i]], in ascending order, in one precision; appends to `rest` those that
/// ask for more than this precision, or more than the easy path, can give.
void project_single(const Batch& batch, std::span<const std::uint32_t> which, Workspace& workspace,
                    std::vector<std::uint32_t>& rest);
void project_double(const Batch& batch, std::span<const std::uint32_t> which, Workspace& workspace,
                    std::vector<std::uint32_t>& rest);

}  // namespace pss::simd
