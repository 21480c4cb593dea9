#include "core/projection.h"

#include <cassert>
#include <cmath>

#include "core/polynomial.h"
#include "core/reference_plane.h"

namespace pss {
namespace {

/// The neighbours within the radius of the point `foot`.
std::uint32_t count_within(const Offsets& offsets, const World3& foot, double radius) {
  const double radius_sq = radius * radius;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double x = offsets.x[i] - foot[0];
    const double y = offsets.y[i] - foot[1];
    const double z = offsets.z[i] - foot[2];
    count += x * x + y * y + z * z < radius_sq ? 1 : 0;
  }
  return static_cast<std::uint32_t>(count);
}

/// Normal and curvatures of z = g(x, y) at the origin, the normal with its canonical sign.
///
/// Source: any text on differential geometry, e.g. do Carmo 1976, section 3-3.
void describe(const LocalMap& map, const Frame& frame, double h, Projection& result) {
  const double gu = map.coefficient(1, 0);
  const double gv = map.coefficient(0, 1);
  const double guu = 2 * map.coefficient(2, 0);
  const double guv = map.coefficient(1, 1);
  const double gvv = 2 * map.coefficient(0, 2);
  const double z = 1 + gu * gu + gv * gv;
  const World3 normal = 1 / std::sqrt(z) * (frame.n - gu * frame.u - gv * frame.v);
  const double bend = (1 + gv * gv) * guu - 2 * gu * gv * guv + (1 + gu * gu) * gvv;
  const double mean = bend / (2 * z * std::sqrt(z)) / h;
  const bool canonical = is_canonical(normal);
  result.normal = canonical ? normal : -normal;
  result.mean_curvature = canonical ? mean : -mean;
  result.gaussian_curvature = (guu * gvv - guv * guv) / (z * z) / h / h;
  result.residual = map.residual * h;
  result.boundary = map.boundary;
}

bool is_finite(const World3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

bool is_finite(const Projection& p) {
  return is_finite(p.displacement) && is_finite(p.normal) && std::isfinite(p.mean_curvature) &&
         std::isfinite(p.gaussian_curvature) && std::isfinite(p.residual) &&
         std::isfinite(p.boundary);
}

/// The result for a point that stays where it is.
Projection staying(Status status, std::uint32_t neighbours) {
  Projection result;
  result.status = status;
  result.neighbours = neighbours;
  return result;
}

}  // namespace

Projection project_levin(const Offsets& neighbours, const Support& support, int degree) {
  assert(0 <= degree && degree <= kMostDegree);
  assert(0 < support.h && support.h <= support.radius);
  const Neighbourhood near{neighbours, 1 / support.h, TaperedGaussian(support.radius / support.h)};
  const ReferencePlane plane = find_reference_plane(near);
  const std::uint32_t count =
      count_within(neighbours, support.h * plane.t * plane.normal, support.radius);
  if (plane.status != Status::kOk) return staying(plane.status, count);

  const Frame frame = frame_of(plane.normal);
  const LocalMap map = fit_local_map(near, frame, plane.t, degree);
  const double height = map.coefficient(0, 0);
  if (map.degree < 0) return staying(Status::kTooFew, count);
  if (!(std::abs(height) < 0.5)) return staying(Status::kOutOfDomain, count);
  Projection result;
  result.status = map.degree < degree ? Status::kDegreeReduced : Status::kOk;
  result.neighbours = count;
  result.displacement = support.h * (plane.t + height) * plane.normal;
  describe(map, frame, support.h, result);
  return is_finite(result) ? result : staying(Status::kDegenerate, count);
}

}  // namespace pss
