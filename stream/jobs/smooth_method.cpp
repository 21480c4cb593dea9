#include "stream/jobs/smooth_method.h"

#include <nlohmann/json.hpp>

#include "stream/jobs/smooth.h"

namespace pss {
namespace {

/// Scaled sums in single precision serve up to here; beyond, too many points are redone.
constexpr int kHighestSingleDegree = 3;

}  // namespace

Precision default_precision(const Method& method) {
  return method.degree <= kHighestSingleDegree ? Precision::kSingle : Precision::kDouble;
}

Method method_of(const SmoothOptions& options) {
  Method method{options.op, options.weight, Precision::kDouble, options.widths.degree};
  if (needs_normals(method.op)) method.degree = kNormalsDegree;
  method.precision = options.precision.value_or(default_precision(method));
  return method;
}

nlohmann::ordered_json method_json(const Method& method) {
  using Json = nlohmann::ordered_json;
  const bool has_order = !needs_normals(method.op);
  return {{"operator", name_of(method.op)},
          {"weight", name_of(method.weight)},
          {"precision", name_of(method.precision)},
          {"polynomial_order", has_order ? Json(method.degree) : Json()}};
}

}  // namespace pss
