#include "io/formats/text/text_detect.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "io/file/file.h"
#include "io/formats/text/text_names.h"
#include "io/points/numbers.h"

namespace pss {
namespace {

using Cells = std::vector<std::string_view>;

/// Lines looked at to tell colours from other numbers.
constexpr int kSampleLines = 100;
/// Comments beyond this many bytes are not carried on.
constexpr std::size_t kCommentLimit = std::size_t{64} << 10;

bool is_number(std::string_view cell) {
  double ignored = 0;
  return parse_number(cell, ignored) == NumberFault::kNone;
}

/// The separator that a line seems to use.
char separator_of(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  if (line.find(',') != std::string_view::npos) return ',';
  if (line.find('\t') == std::string_view::npos) return ' ';
  Cells by_tab;
  Cells by_blanks;
  split_cells(line, '\t', by_tab);
  split_cells(line, ' ', by_blanks);
  return by_tab == by_blanks ? '\t' : ' ';
}

std::optional<std::uint64_t> count_line(std::string_view line) {
  std::uint64_t count = 0;
  const auto [end, fault] = std::from_chars(line.data(), line.data() + line.size(), count);
  if (fault != std::errc{} || end != line.data() + line.size()) return std::nullopt;
  return count;
}

bool is_colour(std::string_view cell) {
  double value = -1;
  return parse_number(cell, value) == NumberFault::kNone && value >= 0 && value <= 255 &&
         value == std::floor(value);
}

/// Reads the lines before the points, then decides.
class Detector {
 public:
  explicit Detector(LineSource& lines) : lines_(lines) {}

  Result<TextStart> detect();

 private:
  struct Comment {
    std::string line;
    bool is_header = false;
  };

  Result<bool> take_line();  ///< false where the points begin, or the file ends
  Result<void> skip_byte_order_mark();
  Result<bool> take_text(std::string_view line);
  Result<void> name_columns();
  Result<void> use_header();
  bool use_comment();
  void keep_comments();
  Result<bool> last_cells_are_colours();

  LineSource& lines_;
  TextStart start_;
  std::vector<Comment> comments_;
  std::size_t comment_bytes_ = 0;
  std::optional<std::string> header_;
  std::size_t columns_ = 0;  ///< of the first point; 0 where there is none
};

Result<TextStart> Detector::detect() {
  start_.layout.extension = extension_of(lines_.path());
  PSS_TRY(skip_byte_order_mark());
  for (bool more = true; more;) {
    PSS_ASSIGN(more, take_line());
  }
  if (columns_ > kTextColumnLimit)
    return lines_.error(
        fmt::format("found {} columns, expected at most {}", columns_, kTextColumnLimit));
  PSS_TRY(name_columns());
  keep_comments();
  lines_.go_to(start_.points);
  return std::move(start_);
}

Result<void> Detector::skip_byte_order_mark() {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  lines_.go_to({});
  PSS_ASSIGN(const std::optional<std::string_view> line, lines_.next());
  const bool marked = line && line->starts_with(kMark);
  lines_.go_to({.offset = marked ? kMark.size() : 0, .line = 0});
  return {};
}

Result<bool> Detector::take_line() {
  start_.points = lines_.place();
  PSS_ASSIGN(const std::optional<std::string_view> found, lines_.next());
  if (!found) return false;
  const std::string_view line = trimmed(*found);
  if (line.empty()) return true;
  if (!comment_prefix(line).empty()) {
    comment_bytes_ += line.size();
    if (comment_bytes_ <= kCommentLimit) comments_.push_back({std::string(line)});
    return true;
  }
  return take_text(line);
}

/// A line that is no comment: a header, a count, or the first point.
Result<bool> Detector::take_text(std::string_view line) {
  if (const auto count = count_line(line); count && !start_.count) {
    start_.count = count;
    start_.layout.counted = true;
    return true;
  }
  Cells cells;
  const char separator = separator_of(line);
  split_cells(line, separator, cells);
  if (!is_number(cells[0])) {
    if (header_)
      return lines_.error("found " + in_quotes(line) + ", expected a point: numbers, x y z ...");
    header_ = line;
    return true;
  }
  if (cells.size() < 3)
    return lines_.error(fmt::format("found {} values, expected at least x, y and z", cells.size()));
  start_.layout.separator = separator;
  columns_ = cells.size();
  return false;
}

Result<void> Detector::name_columns() {
  if (header_) return use_header();
  if (use_comment()) return {};
  if (columns_ == 0) return {};
  PSS_ASSIGN(const bool colours, last_cells_are_colours());
  start_.layout.columns = conventional_names(columns_, colours);
  return {};
}

Result<void> Detector::use_header() {
  TextLayout& layout = start_.layout;
  if (columns_ == 0) layout.separator = separator_of(*header_);
  layout.columns = names_in(*header_, layout.separator);
  if (columns_ != 0 && layout.columns.size() != columns_)
    layout.columns = names_in(*header_, separator_of(*header_));
  const auto axes = find_axes(layout.columns);
  if (!axes || layout.columns.size() > kTextColumnLimit)
    return Error{Fault::kBadInput,
                 fmt::format("{}: found {}, expected points (numbers, x y z ...) or a line that "
                             "names the columns, x, y and z among them",
                             lines_.path(), in_quotes(*header_))};
  layout.axes = *axes;
  layout.header = "";
  make_distinct(layout.columns);
  return {};
}

/// Takes the last comment that could name the columns.
bool Detector::use_comment() {
  TextLayout& layout = start_.layout;
  for (auto comment = comments_.rbegin(); comment != comments_.rend(); ++comment) {
    const std::string_view prefix = comment_prefix(comment->line);
    const std::string_view text = trimmed(std::string_view(comment->line).substr(prefix.size()));
    const char separator = columns_ == 0 ? separator_of(text) : layout.separator;
    std::vector<std::string> names = names_in(text, separator);
    if (columns_ != 0 && names.size() != columns_) names = names_in(text, separator_of(text));
    const auto axes = find_axes(names);
    if (!axes || (columns_ != 0 && names.size() != columns_)) continue;
    if (names.size() > kTextColumnLimit) continue;
    layout.separator = separator;
    layout.axes = *axes;
    layout.header = comment->line.substr(0, prefix.size() + (comment->line[prefix.size()] == ' '));
    layout.columns = std::move(names);
    make_distinct(layout.columns);
    comment->is_header = true;
    return true;
  }
  return false;
}

void Detector::keep_comments() {
  for (Comment& comment : comments_)
    if (!comment.is_header) start_.layout.comments.push_back(std::move(comment.line));
}

Result<bool> Detector::last_cells_are_colours() {
  if (columns_ != 6 && columns_ != 7) return false;
  lines_.go_to(start_.points);
  Cells cells;
  for (int i = 0; i < kSampleLines; ++i) {
    PSS_ASSIGN(const std::optional<std::string_view> line, lines_.next());
    if (!line) break;
    if (trimmed(*line).empty() || !comment_prefix(trimmed(*line)).empty()) continue;
    split_cells(*line, start_.layout.separator, cells);
    // A malformed line is the reader's to report.
    if (cells.size() != columns_) break;
    if (!std::all_of(cells.end() - 3, cells.end(), is_colour)) return false;
  }
  return true;
}

}  // namespace

Result<TextStart> detect_text(LineSource& lines) { return Detector(lines).detect(); }

}  // namespace pss
