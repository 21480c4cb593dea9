#pragma once
// How a query's width and radius follow from each other where only one of them is said.

#include "core/method.h"
#include "core/projection.h"

namespace pss {

/// The default radius over h: 3, and 4 for degree 4; 1 for the weight of PCL, whose only width is
/// its radius.
constexpr double radius_over_h(const Method& method) {
  if (method.weight == WeightKind::kPcl) return 1;
  return radius_factor(needs_normals(method.op) ? kNormalsDegree : method.degree);
}

constexpr Support support_of_radius(double radius, const Method& method) {
  return {radius / radius_over_h(method), radius};
}

constexpr Support support_of_h(double h, const Method& method) {
  return {h, radius_over_h(method) * h};
}

/// As wide as a Gaussian of that width, whatever the weight: it ends at the same radius.
constexpr Support support_of_width(double width, const Method& method) {
  const double radius = radius_factor(needs_normals(method.op) ? kNormalsDegree : method.degree);
  return {(method.weight == WeightKind::kPcl ? radius : 1) * width, radius * width};
}

}  // namespace pss
