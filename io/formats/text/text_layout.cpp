#include "io/formats/text/text_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "io/file/line_source.h"

namespace pss {
namespace {

constexpr std::string_view kMagic = "pss text 1";

bool parse_index(std::string_view token, std::size_t& value) {
  const auto [end, fault] = std::from_chars(token.data(), token.data() + token.size(), value);
  return fault == std::errc{} && end == token.data() + token.size();
}

bool parse_axes(std::string_view text, std::array<std::size_t, 3>& axes) {
  return std::ranges::all_of(
      axes, [&](std::size_t& axis) { return parse_index(next_token(text), axis); });
}

/// Takes in one line of a packed layout.
bool unpack_line(std::string_view line, TextLayout& layout) {
  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos) return false;
  const std::string_view key = line.substr(0, space);
  const std::string value(line.substr(space + 1));
  if (key == "extension") layout.extension = value;
  if (key == "separator" && value.size() == 1) layout.separator = value[0];
  if (key == "comment") layout.comments.push_back(value);
  if (key == "header") layout.header = value;
  if (key == "counted") layout.counted = value == "1";
  if (key == "column") layout.columns.push_back(value);
  return key != "axes" || parse_axes(value, layout.axes);
}

bool is_whole(const TextLayout& layout) {
  return std::ranges::all_of(layout.axes,
                             [&](std::size_t axis) { return axis < layout.columns.size(); });
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace

std::optional<std::size_t> TextLayout::axis(std::size_t column) const {
  const auto found = std::ranges::find(axes, column);
  if (found == axes.end()) return std::nullopt;
  return static_cast<std::size_t>(found - axes.begin());
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') {
    for (auto token = next_token(line); !token.empty(); token = next_token(line))
      cells.push_back(token);
    return;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
}

std::string_view comment_prefix(std::string_view line) {
  if (line.starts_with('#')) return line.substr(0, 1);
  return line.starts_with("//") ? line.substr(0, 2) : std::string_view();
}

std::vector<std::byte> pack(const TextLayout& layout) {
  std::string text = fmt::format("{}\nextension {}\nseparator {}\ncounted {}\naxes {} {} {}\n",
                                 kMagic, layout.extension, layout.separator, layout.counted ? 1 : 0,
                                 layout.axes[0], layout.axes[1], layout.axes[2]);
  if (layout.header) text += fmt::format("header {}\n", *layout.header);
  for (const std::string& comment : layout.comments) text += fmt::format("comment {}\n", comment);
  for (const std::string& column : layout.columns) text += fmt::format("column {}\n", column);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Result<TextLayout> unpack_text_layout(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  TextLayout layout;
  layout.columns.clear();
  bool good = take_line(text) == kMagic;
  while (good && !text.empty()) good = unpack_line(take_line(text), layout);
  if (!good || !is_whole(layout))
    return Error{Fault::kBadInput, "the carried layout of a text file is damaged"};
  return layout;
}

}  // namespace pss
