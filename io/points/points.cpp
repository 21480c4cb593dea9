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

std::optional<Format> format_named(std::string_view name) {
  for (const Format format : {Format::kLas, Format::kPly, Format::kText})
    if (name == format_name(format)) return format;
  return std::nullopt;
}

}  // namespace pss
