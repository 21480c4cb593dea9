#include "core/status.h"

namespace pss {

const char* status_name(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kDegreeReduced:
      return "degree_reduced";
    case Status::kTooFew:
      return "too_few";
    case Status::kDegenerate:
      return "degenerate";
    case Status::kOutOfDomain:
      return "out_of_domain";
    case Status::kIsolated:
      return "isolated";
    case Status::kNotRepresentable:
      return "not_representable";
    case Status::kExcluded:
      return "excluded";
  }
  return "unknown";
}

}  // namespace pss
