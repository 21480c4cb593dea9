#include "stream/smooth_method.h"

#include "stream/smooth.h"

namespace pss {
namespace {

/// Scaled sums in single precision serve up to degree 3. Off: every degree is done in double.
constexpr bool kSingleByDefault = false;
constexpr int kHighestSingleDegree = 3;

}  // namespace

Precision default_precision(const Method& method) {
  return kSingleByDefault && method.degree <= kHighestSingleDegree ? Precision::kSingle
                                                                   : Precision::kDouble;
}

Method method_of(const SmoothOptions& options) {
  Method method{options.op, options.weight, Precision::kDouble, options.widths.degree};
  if (needs_normals(method.op)) method.degree = kNormalsDegree;
  method.precision = options.precision.value_or(default_precision(method));
  return method;
}

Method normals_method(const Method& method) {
  return {MlsOperator::kLevin, method.weight, method.precision, kNormalsDegree};
}

}  // namespace pss
