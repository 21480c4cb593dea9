#pragma once
// Scans of known surfaces for tests: even samples on a fine lattice, projected and measured.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/neighbours.h"
#include "core/projector.h"
#include "core/shapes.h"
#include "core/vec3.h"
#include "tests/support/cloud.h"

namespace pss::test {

/// A cloud with the lattice that it stands on and its mean spacing.
struct Scan {
  Lattice lattice;
  std::vector<Index3> points;
  double spacing = 0;
  std::vector<Normal> normals{};  ///< of the surface, one a point
  bool oriented = true;

  CloudNormals cloud_normals() const { return {normals, oriented}; }
};

/// The nearest lattice positions with the normals that belong to them, in key order.
inline Scan sorted_scan(const Lattice& lattice, std::span<const SurfacePoint> samples) {
  std::vector<std::pair<Index3, Normal>> sorted;
  sorted.reserve(samples.size());
  for (const auto& [position, n] : samples)
    sorted.push_back(
        {to_index(lattice, position),
         {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])}});
  std::ranges::sort(sorted, {}, [](const auto& sample) { return encode_key(sample.first); });
  Scan scan{lattice, {}};
  for (const auto& [position, normal] : sorted) {
    scan.points.push_back(position);
    scan.normals.push_back(normal);
  }
  return scan;
}

/// Even but irregular samples, `spacing` apart on average, moved by noise along the normal.
///
/// Source: the R2 low-discrepancy sequence, M. Roberts, "The Unreasonable Effectiveness of
///         Quasirandom Sequences", 2018.
inline Scan scan_of(const Surface& surface, double spacing, double noise = 0,
                    double step = 0x1p-40) {
  const auto count = static_cast<std::size_t>(area(surface) / (spacing * spacing));
  const double plastic = 1.32471795724474602596;
  Random random(99);
  std::vector<SurfacePoint> samples(count);
  double u = 0.5;
  double v = 0.5;
  for (SurfacePoint& sample : samples) {
    u = std::fmod(u + 1 / plastic, 1.0);
    v = std::fmod(v + 1 / (plastic * plastic), 1.0);
    sample = surface_point(surface, u, v);
    if (noise > 0) sample.position = sample.position + noise * random.normal() * sample.normal;
  }
  Scan scan = sorted_scan({{step, step, step}, {0, 0, 0}}, samples);
  scan.spacing = spacing;
  return scan;
}

/// Whether `n` points the canonical way: its component of largest magnitude, the first of equals,
/// is positive.
inline bool is_canonical(const World3& n) {
  std::size_t largest = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(n[a]) > std::abs(n[largest])) largest = a;
  return n[largest] > 0;
}

inline Method levin(int degree) {
  return {MlsOperator::kLevin, WeightKind::kGaussian, Precision::kDouble, degree};
}

/// A grid over a scan, and the projection of any place onto its surface.
class ScanProjector {
 public:
  ScanProjector(const Scan& scan, const Support& support, const Method& method)
      : lattice_(scan.lattice),
        grid_(scan.lattice, scan.points, reach(method.weight, support)),
        support_(support),
        projector_(grid_, method, scan.cloud_normals()) {}

  Projection operator()(const Query& query) { return (*this)(std::vector{query})[0]; }

  std::vector<Projection> operator()(std::span<const Query> queries) {
    return (*this)(queries, {&support_, 1});
  }

  /// With a support for each query, none wider than the projector's own.
  std::vector<Projection> operator()(std::span<const Query> queries,
                                     std::span<const Support> supports) {
    std::vector<Projection> results(queries.size());
    projector_.project(queries, supports, results);
    return results;
  }

  /// Where the query lies after its projection.
  World3 place(const Query& query, const Projection& p) const {
    return to_world(lattice_, query.position) + query.remainder + p.displacement;
  }

 private:
  Lattice lattice_;
  CellGrid grid_;
  Support support_;
  Projector projector_;
};

/// Calls use(i, offset) for the points nearer to a query than `radius`, by brute force; the offset
/// leads from the query to the point.
template <class Use>
void for_each_within(const Scan& scan, const Query& query, double radius, Use use) {
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    World3 d;
    for (std::size_t a = 0; a < 3; ++a)
      d[a] = scan.lattice.scale[a] * static_cast<double>(scan.points[i][a] - query.position[a]) -
             query.remainder[a];
    if (length_sq(d[0], d[1], d[2]) < radius * radius) use(i, d);
  }
}

/// About `count` of the scan's points, spread over it.
inline std::vector<Query> some_queries(const Scan& scan, std::size_t count) {
  std::vector<Query> queries;
  const std::size_t step = std::max<std::size_t>(1, scan.points.size() / count);
  for (std::size_t i = 0; i < scan.points.size(); i += step) queries.push_back({scan.points[i]});
  return queries;
}

/// Errors of projected points against the true surface, root mean square.
struct Errors {
  double distance = 0;
  double mean_distance = 0;  ///< signed
  double normal = 0;         ///< angle
  double curvature = 0;      ///< of the mean curvature
  double mean_curvature_ratio = 0;
  std::size_t moved = 0;
};

/// Projects about `count` points spread over the scan.
inline Errors measure(const Scan& scan, const Surface& surface, const Support& support,
                      const Method& method, std::size_t count) {
  ScanProjector project(scan, support, method);
  Errors e;
  const std::vector<Query> queries = some_queries(scan, count);
  const std::vector<Projection> results = project(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Projection& p = results[i];
    if (p.status != Status::kOk) continue;
    const Foot foot = foot_of(surface, project.place(queries[i], p));
    const double cosine = dot(p.normal, foot.normal);
    const World3 across = p.normal - cosine * foot.normal;
    const double sign = cosine < 0 ? -1 : 1;
    const double curvature = sign * p.mean_curvature - foot.mean_curvature;
    e.distance += foot.distance * foot.distance;
    e.mean_distance += foot.distance;
    e.normal += dot(across, across);
    e.curvature += curvature * curvature;
    e.mean_curvature_ratio += sign * p.mean_curvature / foot.mean_curvature;
    ++e.moved;
  }
  const auto n = static_cast<double>(e.moved);
  e.mean_distance /= n;
  e.mean_curvature_ratio /= n;
  e.distance = std::sqrt(e.distance / n);
  e.normal = std::sqrt(e.normal / n);
  e.curvature = std::sqrt(e.curvature / n);
  return e;
}

}  // namespace pss::test
