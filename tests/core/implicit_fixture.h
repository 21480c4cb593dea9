#pragma once
// What tests of the operators with normals share: projections of places, and a sheet of points.

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "tests/support/methods.h"
#include "tests/support/scan.h"

namespace pss::test {

inline constexpr std::array kImplicit{MlsOperator::kApss, MlsOperator::kRimls};

inline Method implicit(MlsOperator op, Precision precision = Precision::kDouble,
                       WeightKind weight = WeightKind::kGaussian) {
  return {op, weight, precision, 3};
}

/// Projects places of a scan with its normals, oriented or of unknown side.
inline std::vector<Projection> project_all(const Scan& scan, const Support& support,
                                           const Method& method, std::span<const Query> queries,
                                           bool oriented = true) {
  const CellGrid grid(scan.lattice, scan.points, reach(method.weight, support));
  Projector projector(grid, method, {scan.normals, oriented});
  std::vector<Projection> results(queries.size());
  projector.project(queries, {&support, 1}, results);
  return results;
}

/// The projection of the origin, h = 1, R = 3, with what lies around it.
inline Projection project_origin(const std::vector<SurfacePoint>& around, const Method& method,
                                 bool oriented = true) {
  const Scan scan = sorted_scan({{0x1p-30, 0x1p-30, 0x1p-30}, {0, 0, 0}}, around);
  return project_all(scan, {1, 3}, method, std::vector<Query>(1), oriented)[0];
}

inline double size(const World3& v) { return std::sqrt(dot(v, v)); }

/// A square grid of points in z = height, about the origin.
inline std::vector<SurfacePoint> sheet(double height, double up = 1) {
  std::vector<SurfacePoint> points;
  for (int i = -16; i <= 16; ++i)
    for (int j = -16; j <= 16; ++j) points.push_back({{0.25 * i, 0.25 * j, height}, {0, 0, up}});
  return points;
}

}  // namespace pss::test
