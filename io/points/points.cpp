#include "io/points/points.h"

namespace pss {

const char* format_name(Format format) {
  switch (format) {
    case Format::kLas:
      return "LAS";
    case Format::kPly:
      return "PLY";
    case Format::kText:
      return "text";
  }
  return "unknown";
}

}  // namespace pss
