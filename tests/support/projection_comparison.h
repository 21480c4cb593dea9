#pragma once
// Compares what a projector gives with what the reference gives for the same places.

#include <gtest/gtest.h>

#include <string>

#include "tests/support/projection_oracle.h"
#include "tests/support/scan.h"

namespace pss::test {

/// The reference's result for one place of a scan, by brute force over all of its points.
template <class Real>
Projection oracle_at(const Scan& scan, const Query& query, const Support& support,
                     const Method& method) {
  std::vector<World3> offsets;
  std::vector<World3> normals;
  for_each_within(scan, query, reach(method.weight, support),
                  [&](std::size_t i, const World3& offset) {
                    offsets.push_back(offset);
                    const Normal& n = scan.normals[i];
                    normals.push_back({n[0], n[1], n[2]});
                  });
  return project_by_oracle<Real>(offsets, support, method, {normals, scan.oriented});
}

/// How far two results may lie apart.
struct Tolerance {
  double position = 0;   ///< of the spacing
  double normal = 0;     ///< radians
  double curvature = 0;  ///< of 1/h, Gaussian of 1/h^2
  double direction = 0;  ///< radians, where the principal curvatures differ by 1/h
  double residual = 0;   ///< of h
  double boundary = 0;
  std::uint32_t neighbours = 0;
};

/// What rounding leaves; the residual is a difference, about 1e-8 of the heights at best.
inline Tolerance tolerance_of(const Method& method) {
  Tolerance t{1e-11, 1e-10, 1e-9, 4e-9, 4e-8, 1e-11, 0};
  if (method.precision == Precision::kSingle) t = {1e-4, 1e-4, 2e-3, 1e-2, 5e-4, 1e-4, 2};
  return t;
}

/// What became of places that were projected twice.
struct Agreement {
  int same = 0;         ///< one status, one foot
  int other_foot = 0;   ///< both moved, but to different places
  int other_state = 0;  ///< differing statuses
};

inline double length(const World3& v) { return std::sqrt(dot(v, v)); }

/// Twice the square root of H^2 - K: k1 - k2.
inline double curvature_gap(const Projection& p) {
  const double h = p.mean_curvature;
  return 2 * std::sqrt(std::max(0.0, h * h - p.gaussian_curvature));
}

/// |sin| of the angle between the directions; 0 where either is missing.
inline double direction_error(const Projection& a, const Projection& b) {
  const World3& x = a.principal_direction;
  const World3& y = b.principal_direction;
  return dot(x, x) > 0 && dot(y, y) > 0 ? length(x - dot(x, y) * y) : 0;
}

/// Expects the same of both up to the tolerance, unless they went different ways.
inline void expect_near(const Projection& actual, const Projection& expected, double s, double h,
                        const Tolerance& tolerance, Agreement& agreement) {
  if (actual.status != expected.status) {
    ++agreement.other_state;
    return;
  }
  const double apart = length(actual.displacement - expected.displacement);
  if (apart > 0.01 * s && apart > 100 * tolerance.position * s) {
    ++agreement.other_foot;
    return;
  }
  ++agreement.same;
  EXPECT_LE(apart, tolerance.position * s);
  const double side = dot(actual.normal, expected.normal) < 0 ? -1 : 1;  // tie of components
  EXPECT_LE(length(actual.normal - side * expected.normal), tolerance.normal);
  EXPECT_NEAR(h * actual.mean_curvature, side * h * expected.mean_curvature, tolerance.curvature);
  EXPECT_NEAR(h * h * actual.gaussian_curvature, h * h * expected.gaussian_curvature,
              tolerance.curvature);
  EXPECT_LE(h * curvature_gap(expected) * direction_error(actual, expected), tolerance.direction);
  EXPECT_NEAR(actual.residual, expected.residual, tolerance.residual * h);
  EXPECT_NEAR(actual.boundary, expected.boundary, tolerance.boundary);
  EXPECT_NEAR(actual.neighbours, expected.neighbours, tolerance.neighbours);
  EXPECT_EQ(actual.second_sheet, expected.second_sheet);
}

}  // namespace pss::test
