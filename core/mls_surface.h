#pragma once
// The MLS surface of points in memory: what a program needs to use pss as a library.

#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/method.h"
#include "core/mls_options.h"
#include "core/neighbours.h"
#include "core/projection.h"
#include "core/projector.h"
#include "core/result.h"
#include "core/sorted_cloud.h"

namespace pss {

/// Where queries were carried, and what the surface is like there.
struct Projected {
  std::vector<World3> positions;
  std::vector<Projection> results;
};

/// The moving least squares surface of a cloud, which it copies.
///
/// The result of a query depends on the points near it alone: not on their order or on that of the
/// queries, not on threads or vector width. It is what `pss smooth` gives for the same points,
/// lattice, method and widths (up to rounding where points share a position but not a normal).
class MlsSurface {
 public:
  /// Sorts the points and prepares the search for neighbours.
  ///
  /// Shape:  `normals` in the order of `points`, or none: where the operator needs them, a first
  ///         pass of levin computes them.
  /// Errors: kUsage for options that make no sense; kBadInput as sort_cloud().
  /// Thread: one.
  /// Cost:   O(n log n); keeps 28 to 40 bytes a point and some for the search.
  static Result<MlsSurface> create(std::span<const World3> points, const MlsOptions& options = {},
                                   const CloudNormals& normals = {});

  MlsSurface(MlsSurface&&) = default;
  MlsSurface& operator=(MlsSurface&&) = default;
  MlsSurface(const MlsSurface&) = delete;
  MlsSurface& operator=(const MlsSurface&) = delete;

  /// Carries each query, evaluated exactly where it is, onto the surface.
  ///
  /// A query whose status is not moved() keeps its position; so does one that is far from all
  /// points or not finite (kTooFew; with knn kIsolated).
  ///
  /// Shape:    as many positions as queries, which they may overwrite; as many results, or none.
  /// Thread:   any number at once; each call uses the threads that ThreadLimit allows.
  /// Cost:     the operator's for each distinct query; sorts the queries, 24 bytes each.
  void project(std::span<const World3> queries, std::span<World3> positions,
               std::span<Projection> results) const;
  Projected project(std::span<const World3> queries) const;

  /// The projections of the cloud's own points, as rounded to the lattice, in the caller's order.
  ///
  /// Thread, Cost: as project(), but nothing is sorted.
  std::vector<Projection> project_points() const;

  /// The width and radius of all queries; zeros with knn, and where the points are too few to have
  /// a spacing (no query moves then).
  const Support& support() const { return widths_.support; }
  const Lattice& lattice() const { return cloud_.lattice; }
  std::size_t size() const { return cloud_.points.size(); }

 private:
  MlsSurface(SortedCloud cloud, bool oriented, const Method& method, const MlsWidths& widths);
  static SortedCloud with_normals(SortedCloud cloud, const Method& method, const MlsWidths& widths);
  Query query_at(const World3& place) const;
  std::optional<Support> support_of(const Query& query) const;
  bool in_reach(const World3& place) const;
  Projection lonely() const;
  template <class QueryAt, class Use>
  void for_each_projection(std::size_t count, QueryAt query_at, Use use) const;
  template <class Use>
  void for_each_point(Use use) const;

  SortedCloud cloud_;
  bool oriented_;
  Method method_;
  MlsWidths widths_;
  WorldBox bounds_;
  CellGrid grid_;
};

/// Carries every point of a cloud onto the cloud's own surface; those not moved() stay as they are.
///
/// Errors, Cost: as MlsSurface.
Result<Projected> smooth(std::span<const World3> points, const MlsOptions& options = {},
                         const CloudNormals& normals = {});

}  // namespace pss
