#include "io/points/common_crs.h"

#include <fmt/format.h>

namespace pss {
namespace {

/// Enough of a text to tell it from another.
std::string shortened(const std::string& text) {
  constexpr std::size_t kLongest = 160;
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

}  // namespace

Result<void> CommonCrs::add(const CloudHeader& header) {
  if (header.crs.empty() || header.crs == text_) return {};
  if (!text_.empty())
    return Error{Fault::kBadInput,
                 fmt::format("{}: found the coordinate system {}, expected {} as in {}; bring "
                             "the files into one system first",
                             header.path, shortened(header.crs), shortened(text_), path_)};
  path_ = header.path;
  text_ = header.crs;
  return {};
}

}  // namespace pss
