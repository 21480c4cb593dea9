#include "io/points/wkt.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

namespace pss {
namespace {

constexpr int kDeepest = 32;

/// KEYWORD["name", value, ..., CHILD[...], ...]; quoted texts and values are both in `values`.
struct Node {
  std::string keyword;
  std::vector<std::string> values;
  std::vector<Node> children;
};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::optional<Node> node(int depth = 0) {
    Node result;
    result.keyword = word();
    if (depth > kDeepest || result.keyword.empty() || !take("[(")) return std::nullopt;
    do {
      if (!argument(result, depth)) return std::nullopt;
    } while (take(","));
    if (!take("])")) return std::nullopt;
    return result;
  }

 private:
  bool argument(Node& into, int depth) {
    skip_space();
    if (at_ < text_.size() && text_[at_] == '"') return quoted(into);
    const std::size_t start = at_;
    const std::string value = word();
    skip_space();
    if (at_ < text_.size() && (text_[at_] == '[' || text_[at_] == '(')) {
      at_ = start;
      std::optional<Node> child = node(depth + 1);
      if (!child) return false;
      into.children.push_back(std::move(*child));
      return true;
    }
    into.values.push_back(value);
    return !value.empty();
  }

  bool quoted(Node& into) {
    const std::size_t end = text_.find('"', at_ + 1);
    if (end == std::string_view::npos) return false;
    into.values.emplace_back(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return true;
  }

  std::string word() {
    skip_space();
    const std::size_t start = at_;
    while (at_ < text_.size() &&
           std::string_view("[](),\" \t\r\n").find(text_[at_]) == std::string_view::npos)
      ++at_;
    return std::string(text_.substr(start, at_ - start));
  }

  bool take(std::string_view any) {
    skip_space();
    if (at_ >= text_.size() || any.find(text_[at_]) == std::string_view::npos) return false;
    ++at_;
    return true;
  }

  void skip_space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

template <std::size_t N>
bool is_one_of(const std::string& keyword, const std::array<const char*, N>& all) {
  return std::ranges::find(all, keyword) != all.end();
}

/// The first projected system of the tree, else the first geographic one.
const Node* horizontal(const Node& node) {
  constexpr std::array kProjected{"PROJCS", "PROJCRS"};
  constexpr std::array kGeographic{"GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS"};
  if (is_one_of(node.keyword, kProjected) || is_one_of(node.keyword, kGeographic)) return &node;
  for (const Node& child : node.children)
    if (const Node* found = horizontal(child)) return found;
  return nullptr;
}

/// The EPSG code that a node names for itself, or nothing.
std::string own_code(const Node& node) {
  constexpr std::array kAuthority{"AUTHORITY", "ID"};
  for (const Node& child : node.children)
    if (is_one_of(child.keyword, kAuthority) && child.values.size() >= 2 &&
        child.values[0] == "EPSG")
      return child.values[1];
  return {};
}

std::string plain(std::string_view name) {
  std::string result;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Numbers with as many digits as writers agree on, other words as they are.
std::string value_text(const std::string& value) {
  double number = 0;
  const char* end = value.data() + value.size();
  const auto [rest, code] = std::from_chars(value.data(), end, number);
  return code == std::errc() && rest == end ? fmt::format("{:.9g}", number) : plain(value);
}

void describe(const Node& node, std::string& out) {
  constexpr std::array kFree{"AUTHORITY", "ID",    "AXIS",  "CS",   "TOWGS84", "EXTENSION",
                             "REMARK",    "USAGE", "SCOPE", "AREA", "BBOX"};
  constexpr std::array kNamed{"PROJECTION", "METHOD", "PARAMETER"};
  if (is_one_of(node.keyword, kFree)) return;
  const std::string code = node.keyword == "DATUM" ? own_code(node) : std::string();
  out += node.keyword + "[" + code;
  const bool named = is_one_of(node.keyword, kNamed) || (node.keyword == "DATUM" && code.empty());
  for (std::size_t i = named ? 0 : 1; i < node.values.size(); ++i)
    out += value_text(node.values[i]) + ",";
  for (const Node& child : node.children) describe(child, out);
  out += "]";
}

}  // namespace

std::string comparable_wkt(std::string_view wkt) {
  const std::optional<Node> root = Parser(wkt).node();
  if (!root) return {};
  const Node* system = horizontal(*root);
  const Node& described = system ? *system : *root;
  const std::string code = own_code(described);
  if (!code.empty()) return "EPSG:" + code;
  std::string text;
  describe(described, text);
  return text;
}

}  // namespace pss
