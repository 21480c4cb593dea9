#include "io/formats/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "io/file/file.h"

namespace pss {
namespace {

/// "a, b or c".
std::string joined(const std::vector<std::string>& words, std::string_view conjunction) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? conjunction : ", ";
    text += words[i];
  }
  return text;
}

/// The name, and the extensions where they are not just that.
std::string described(const Format& format) {
  if (format.extensions.size() < 2) return std::string(format.name);
  return fmt::format("{} ({})", format.name, fmt::join(format.extensions, ", "));
}

}  // namespace

const Format* find_format(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name, [](const Format* f) { return f->name; });
  return found == kFormats.end() ? nullptr : *found;
}

const Format* format_by_extension(const std::string& path) {
  const std::string extension = extension_of(path);
  const auto has_it = [&](const Format* format) {
    return std::ranges::find(format->extensions, extension) != format->extensions.end();
  };
  const auto found = std::ranges::find_if(kFormats, has_it);
  return found == kFormats.end() ? nullptr : *found;
}

std::string readable_formats() {
  std::vector<std::string> words;
  for (const Format* format : kFormats) words.push_back(described(*format));
  return joined(words, " or ");
}

std::string writable_extensions(std::string_view conjunction) {
  std::vector<std::string> words;
  for (const Format* format : kFormats)
    if (format->create)
      words.insert(words.end(), format->extensions.begin(), format->extensions.end());
  return joined(words, conjunction);
}

std::string gridded_formats(std::string_view conjunction) {
  std::vector<std::string> words;
  for (const Format* format : kFormats)
    if (format->integer_grid) words.emplace_back(format->name);
  return joined(words, conjunction);
}

}  // namespace pss
