#include "stream/jobs/json_text.h"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

namespace pss {
namespace {

bool is_utf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

}  // namespace

std::string json_text_of(const std::string& name) {
  if (name.find('%') == std::string::npos && is_utf8(name)) return name;
  std::string text;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    text += byte > 127 || c == '%' ? fmt::format("%{:02X}", byte) : std::string(1, c);
  }
  return text;
}

std::string name_of_json_text(const std::string& text) {
  std::string name;
  for (std::size_t at = 0; at < text.size(); ++at) {
    unsigned byte = 0;
    const bool whole = text[at] == '%' && at + 2 < text.size() &&
                       std::from_chars(&text[at + 1], &text[at + 3], byte, 16).ptr == &text[at + 3];
    name += whole ? static_cast<char>(byte) : text[at];
    if (whole) at += 2;
  }
  return name;
}

}  // namespace pss
