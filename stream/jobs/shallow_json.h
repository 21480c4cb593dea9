#pragma once
// Reads JSON that a file holds: nested no deeper than anything pss writes.

#include <nlohmann/json.hpp>
#include <string_view>

namespace pss {

/// Values that lie deeper than 16 are left out: copying, comparing and writing them recurses.
///
/// Gives a discarded value where the text is no JSON.
template <class Json>
Json parse_shallow(std::string_view text) {
  const auto keep = [](int depth, auto /*event*/, const auto& /*value*/) { return depth <= 16; };
  return Json::parse(text.begin(), text.end(), keep, false);
}

}  // namespace pss
