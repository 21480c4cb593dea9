#include "core/method.h"

namespace pss {

const char* name_of(MlsOperator op) {
  switch (op) {
    case MlsOperator::kLevin:
      return "levin";
    case MlsOperator::kFast:
      return "fast";
    case MlsOperator::kApss:
      return "apss";
    case MlsOperator::kRimls:
      return "rimls";
  }
  return "unknown";
}

const char* name_of(WeightKind weight) {
  switch (weight) {
    case WeightKind::kGaussian:
      return "gaussian";
    case WeightKind::kWendland:
      return "wendland";
    case WeightKind::kPcl:
      return "pcl";
  }
  return "unknown";
}

const char* name_of(Precision precision) {
  return precision == Precision::kDouble ? "double" : "single";
}

Method normals_method(const Method& method) {
  return {MlsOperator::kLevin, method.weight, method.precision, kNormalsDegree};
}

}  // namespace pss
