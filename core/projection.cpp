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

/// The principal direction of z = g(x, y) whose curvature is k: both rows of the eigenproblem of
/// the fundamental forms give it, the longer one more precisely.
World3 direction_of(double k, const LocalMap& map, const Frame& frame, double root) {
  const double gu = map.coefficient(1, 0);
  const double gv = map.coefficient(0, 1);
  const double a = 2 * map.coefficient(2, 0) - k * root * (1 + gu * gu);
  const double b = map.coefficient(1, 1) - k * root * gu * gv;
  const double c = 2 * map.coefficient(0, 2) - k * root * (1 + gv * gv);
  const bool first = a * a + b * b >= b * b + c * c;
  const double x = first ? -b : -c;
  const double y = first ? a : b;
  const World3 tangent = x * frame.u + y * frame.v + (x * gu + y * gv) * frame.n;
  if (!(dot(tangent, tangent) > 0)) return {0, 0, 0};
  const World3 unit = normalized(tangent);
  return is_canonical(unit) ? unit : -unit;
}

/// Normal and curvatures of z = g(x, y) at the origin, the normal with its canonical sign.
///
/// Source: any text on differential geometry, e.g. do Carmo 1976, section 3-3.
void describe(const LocalMap& map, const Frame& frame, double h, Projection& result) {
  constexpr double kRound = 1e-12;  // principal curvatures nearer than this are equal
  const double gu = map.coefficient(1, 0);
  const double gv = map.coefficient(0, 1);
  const double guu = 2 * map.coefficient(2, 0);
  const double guv = map.coefficient(1, 1);
  const double gvv = 2 * map.coefficient(0, 2);
  const double z = 1 + gu * gu + gv * gv;
  const World3 normal = 1 / std::sqrt(z) * (frame.n - gu * frame.u - gv * frame.v);
  const double bend = (1 + gv * gv) * guu - 2 * gu * gv * guv + (1 + gu * gu) * gvv;
  const double mean = bend / (2 * z * std::sqrt(z));
  const double gaussian = (guu * gvv - guv * guv) / (z * z);
  const bool canonical = is_canonical(normal);
  const double spread_sq = mean * mean - gaussian;
  if (spread_sq > kRound * mean * mean) {
    // The larger one by the final sign of the normal.
    const double k = canonical ? mean + std::sqrt(spread_sq) : mean - std::sqrt(spread_sq);
    result.principal_direction = direction_of(k, map, frame, std::sqrt(z));
  }
  result.normal = canonical ? normal : -normal;
  result.mean_curvature = (canonical ? mean : -mean) / h;
  result.gaussian_curvature = gaussian / h / h;
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

Projection project_point(const Offsets& neighbours, const Support& support, const Method& method) {
  assert(0 <= method.degree && method.degree <= kMostDegree);
  assert(0 < support.h && support.h <= support.radius);
  assert(!needs_normals(method.op));
  const double radius = support.radius / support.h;
  const Neighbourhood near{neighbours, 1 / support.h, make_weight(method.weight, radius)};
  const ReferencePlane plane =
      method.op == MlsOperator::kFast ? find_settled_plane(near) : find_reference_plane(near);
  const std::uint32_t count =
      count_within(neighbours, support.h * plane.t * plane.normal, support.radius);
  if (plane.status != Status::kOk) return staying(plane.status, count);

  const Frame frame = frame_of(plane.normal);
  const LocalMap map = fit_local_map(near, frame, plane.t, radius, method.degree);
  const double height = map.coefficient(0, 0);
  if (map.degree < 0) return staying(Status::kTooFew, count);
  if (!(std::abs(height) < 0.5)) return staying(Status::kOutOfDomain, count);
  Projection result;
  result.status = map.degree < method.degree ? Status::kDegreeReduced : Status::kOk;
  result.neighbours = map.neighbours;
  result.second_sheet = map.second_sheet;
  result.displacement = support.h * (plane.t + height) * plane.normal;
  describe(map, frame, support.h, result);
  return is_finite(result) ? result : staying(Status::kDegenerate, count);
}

}  // namespace pss
