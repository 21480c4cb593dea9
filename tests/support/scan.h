#pragma once
// Scans of known surfaces for tests: even samples on a fine lattice, projected and measured.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/neighbours.h"
#include "core/projection.h"
#include "core/shapes.h"
#include "core/vec3.h"
#include "tests/support/cloud.h"

namespace pss::test {

/// A cloud with the lattice that it stands on and its mean spacing.
struct Scan {
  Lattice lattice;
  std::vector<Index3> points;
  double spacing = 0;
};

/// Even but irregular samples, `spacing` apart on average, moved by noise along the normal.
///
/// Source: the R2 low-discrepancy sequence, M. Roberts, "The Unreasonable Effectiveness of
///         Quasirandom Sequences", 2018.
inline Scan scan_of(const Surface& surface, double spacing, double noise = 0,
                    double step = 0x1p-40) {
  const auto count = static_cast<std::size_t>(area(surface) / (spacing * spacing));
  const double plastic = 1.32471795724474602596;
  Random random(99);
  std::vector<World3> world(count);
  double u = 0.5;
  double v = 0.5;
  for (World3& p : world) {
    u = std::fmod(u + 1 / plastic, 1.0);
    v = std::fmod(v + 1 / (plastic * plastic), 1.0);
    const SurfacePoint on = surface_point(surface, u, v);
    p = on.position;
    if (noise > 0) p = p + noise * random.normal() * on.normal;
  }
  Scan scan{{{step, step, step}, {0, 0, 0}}, {}, spacing};
  scan.points = on_lattice_sorted(scan.lattice, world);
  return scan;
}

/// A grid over a scan, and the projection of any place onto its surface.
class Projector {
 public:
  Projector(const Scan& scan, const Support& support, int degree)
      : lattice_(scan.lattice),
        grid_(scan.lattice, scan.points, reach(support)),
        support_(support),
        degree_(degree) {}

  Projection operator()(const Query& query) {
    grid_.gather(query, reach(support_), offsets_);
    return project_levin(offsets_, support_, degree_);
  }

  /// Where the query lies after its projection.
  World3 place(const Query& query, const Projection& p) const {
    return to_world(lattice_, query.position) + query.remainder + p.displacement;
  }

 private:
  Lattice lattice_;
  CellGrid grid_;
  Support support_;
  int degree_;
  Offsets offsets_;
};

/// Errors of projected points against the true surface, root mean square.
struct Errors {
  double distance = 0;
  double mean_distance = 0;  ///< signed
  double normal = 0;         ///< angle
  double curvature = 0;      ///< of the mean curvature
  double mean_curvature_ratio = 0;
  std::size_t moved = 0;
};

/// Projects about `queries` points spread over the scan.
inline Errors measure(const Scan& scan, const Surface& surface, const Support& support, int degree,
                      std::size_t queries) {
  Projector project(scan, support, degree);
  Errors e;
  const std::size_t step = std::max<std::size_t>(1, scan.points.size() / queries);
  for (std::size_t i = 0; i < scan.points.size(); i += step) {
    const Query query{scan.points[i]};
    const Projection p = project(query);
    if (p.status != Status::kOk) continue;
    const Foot foot = foot_of(surface, project.place(query, p));
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
