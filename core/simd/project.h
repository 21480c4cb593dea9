#pragma once
// The door to the kernels: a batch of queries, carried out by the widest vectors of the machine.

#include <algorithm>
#include <array>
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

  /// Makes room for `more` behind the first `kept`.
  void reserve(std::size_t kept, std::size_t more, bool normals) {
    if (kept + more <= x.capacity()) return;
    for (Buffer<T>* buffer : {&x, &y, &z}) buffer->reserve(kept + more, kept);
    if (!normals) return;
    for (Buffer<T>* buffer : {&nx, &ny, &nz}) buffer->reserve(kept + more, kept);
  }
};

/// Consecutive candidates that are looked at together: a whole number of vectors in every target.
inline constexpr std::size_t kChunk = 16;

/// More candidates are looked at one such slice after the other.
inline constexpr std::size_t kMostCandidates = std::size_t{1} << 15;

/// The candidates of a run of queries in chunks, and the chunks' boxes.
template <class I>
struct CandidateChunks {
  Buffer<I> x, y, z;
  std::array<Buffer<I>, 3> low, high;

  void reserve(std::size_t chunks) {
    for (Buffer<I>* buffer : {&x, &y, &z}) buffer->reserve(chunks * kChunk + kChunk);
    for (Buffer<I>& buffer : low) buffer.reserve(chunks + kChunk);
    for (Buffer<I>& buffer : high) buffer.reserve(chunks + kChunk);
  }
};

/// All that a thread needs again for the next batch.
struct Workspace {
  static constexpr std::size_t kMostLanes = 16;

  std::vector<PointRange> ranges, slice;
  CandidateChunks<std::int32_t> narrow;
  CandidateChunks<double> wide;
  Buffer<std::int64_t> touched;  // chunks that a query looks at
  Buffer<float> normal_x, normal_y, normal_z;
  LaneRow<float> single[kMostLanes];
  LaneRow<double> twice[kMostLanes];
  Buffer<std::byte> balls, normals, stage;
};

/// How far the search for a reference plane goes; only `levin` in double tells the two apart.
enum class Search {
  kEasy,   ///< Newton's method; lanes that need a safeguard are left
  kWhole,  ///< with every safeguard; no lane is left
};

/// Projects queries[which[i]], in ascending order, and appends to `rest` those whose numbers ask
/// for more: than single precision, or than the easy search.
///
/// Ensures: nothing is appended in double precision, but for the easy search of `levin`.
void project(const Batch& batch, Precision precision, Search search,
             std::span<const std::uint32_t> which, Workspace& workspace,
             std::vector<std::uint32_t>& rest);

}  // namespace pss::simd
