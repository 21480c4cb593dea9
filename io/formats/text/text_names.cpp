#include "io/formats/text/text_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>

#include "io/file/line_source.h"
#include "io/formats/text/text_layout.h"

namespace pss {
namespace {

std::string_view unquoted(std::string_view name) {
  const bool quotes = name.size() >= 2 && name.front() == name.back() &&
                      (name.front() == '"' || name.front() == '\'');
  return quotes ? trimmed(name.substr(1, name.size() - 2)) : name;
}

/// "Easting [m]" as "easting".
std::string plain_name(std::string_view name) {
  std::string plain(trimmed(name.substr(0, name.find_first_of("[("))));
  for (char& c : plain)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return plain;
}

std::optional<std::size_t> find_named(const std::vector<std::string>& names,
                                      std::initializer_list<std::string_view> accepted) {
  for (const std::string_view wanted : accepted)
    for (std::size_t i = 0; i < names.size(); ++i)
      if (plain_name(names[i]) == wanted) return i;
  return std::nullopt;
}

}  // namespace

std::optional<std::array<std::size_t, 3>> find_axes(const std::vector<std::string>& names) {
  const auto x = find_named(names, {"x", "easting", "east", "e"});
  const auto y = find_named(names, {"y", "northing", "north", "n"});
  const auto z = find_named(names, {"z", "elevation", "height", "altitude", "h"});
  if (!x || !y || !z) return std::nullopt;
  return std::array{*x, *y, *z};
}

std::vector<std::string> names_in(std::string_view header, char separator) {
  std::vector<std::string_view> cells;
  split_cells(header, separator, cells);
  std::vector<std::string> names;
  for (const std::string_view cell : cells) names.emplace_back(unquoted(cell));
  return names;
}

void make_distinct(std::vector<std::string>& names) {
  std::set<std::string> taken;
  std::map<std::string, int> last;  // number of each name: the smaller ones stay taken
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) names[i] = fmt::format("c{}", i + 1);
    const std::string name = names[i];
    for (int& n = last.try_emplace(name, 1).first->second; !taken.insert(names[i]).second;)
      names[i] = fmt::format("{}_{}", name, ++n);
  }
}

std::vector<std::string> conventional_names(std::size_t count, bool colours) {
  if (count == 4) return {"x", "y", "z", "Intensity"};
  if (count == 6 && colours) return {"x", "y", "z", "Red", "Green", "Blue"};
  if (count == 7 && colours) return {"x", "y", "z", "Intensity", "Red", "Green", "Blue"};
  std::vector<std::string> names{"x", "y", "z"};
  while (names.size() < count) names.push_back(fmt::format("c{}", names.size() + 1));
  return names;
}

}  // namespace pss
