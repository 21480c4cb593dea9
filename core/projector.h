#pragma once
// Projects many points at once onto the MLS surface of a cloud, one point a vector lane.

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "core/method.h"
#include "core/neighbours.h"
#include "core/projection.h"

namespace pss {

/// A unit normal; all zero where a point has none, which then has no weight where normals count.
using Normal = std::array<float, 3>;

/// The normals of a cloud, one a point in the grid's order.
struct CloudNormals {
  std::span<const Normal> values;
  bool oriented = false;  ///< otherwise every neighbourhood turns its normals to agree
};

/// Carries queries onto the surface of the points of one grid.
///
/// The result of a query depends on the neighbours within reach alone: not on the other queries,
/// on their order, on the vector width or on the rest of the cloud.
class Projector {
 public:
  /// Requires: `grid` and `normals` outlive this; normals where needs_normals(method.op).
  Projector(const CellGrid& grid, const Method& method, const CloudNormals& normals = {});
  ~Projector();
  Projector(const Projector&) = delete;
  Projector& operator=(const Projector&) = delete;

  /// Fills results[i] for queries[i].
  ///
  /// Shape:    `supports` holds one for all queries or one for each; as many results as queries.
  /// Requires: 0 < h <= radius; fastest where queries are in key order.
  /// Thread:   one call at a time; a projector a thread.
  /// Cost:     memory grows to what the largest ball needs, bytes_for() of it.
  void project(std::span<const Query> queries, std::span<const Support> supports,
               std::span<Projection> results);

  /// What a projector allocates at most when no ball holds more than `ball_points` points.
  static std::size_t bytes_for(std::size_t ball_points, MlsOperator op = MlsOperator::kLevin);

 private:
  struct Workspace;
  const CellGrid& grid_;
  Method method_;
  CloudNormals normals_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace pss
