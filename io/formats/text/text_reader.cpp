#include "io/formats/text/text_reader.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>
#include <vector>

#include "io/file/line_source.h"
#include "io/formats/text/text_detect.h"
#include "io/formats/text/text_format.h"
#include "io/points/numbers.h"

namespace pss {
namespace {

/// The shortest line that is a point: "0 0 0" and its end.
constexpr std::uint64_t kShortestPoint = 6;

class TextReader final : public Reader {
 public:
  TextReader(LineSource lines, TextStart start);

  const CloudHeader& header() const override { return header_; }
  Result<void> read(std::size_t max, PointBatch& batch) override;
  Result<void> seek(std::uint64_t record) override;

 private:
  Result<std::optional<std::string_view>> next_point();
  Result<void> parse(std::string_view line, PointBatch& batch);
  Result<void> check_end() const;
  Error wrong_number(std::size_t column, NumberFault fault) const;

  LineSource lines_;
  TextStart start_;
  CloudHeader header_;
  std::vector<std::optional<std::size_t>> axes_;  ///< of each column
  std::uint64_t next_ = 0;
  std::vector<std::string_view> cells_;
};

TextReader::TextReader(LineSource lines, TextStart start)
    : lines_(std::move(lines)), start_(std::move(start)) {
  const TextLayout& layout = start_.layout;
  header_.path = lines_.path();
  header_.format = kTextFormat.name;
  header_.count = start_.count;
  header_.carry = {.family = std::string(kTextFormat.family), .head = pack(layout), .tail = {}};
  header_.carry_size = header_.carry.head.size();
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    axes_.push_back(layout.axis(i));
    if (!axes_.back()) header_.schema.add({layout.columns[i], Type::kFloat64, 1, 1, 0, {}});
  }
}

Result<void> TextReader::read(std::size_t max, PointBatch& batch) {
  batch.clear();
  batch.first_record = next_;
  for (; batch.size() < max; ++next_) {
    PSS_ASSIGN(const std::optional<std::string_view> line, next_point());
    if (!line) return check_end();
    PSS_TRY(parse(*line, batch));
  }
  return {};
}

/// The next line that is neither blank nor a comment.
Result<std::optional<std::string_view>> TextReader::next_point() {
  for (;;) {
    PSS_ASSIGN(const std::optional<std::string_view> found, lines_.next());
    if (!found) return found;
    const std::string_view line = trimmed(*found);
    if (line.empty() || !comment_prefix(line).empty()) continue;
    if (start_.count && next_ >= *start_.count)
      return lines_.error(fmt::format(
          "found {} behind the last of {} promised points, expected the end of the file",
          in_quotes(line), *start_.count));
    return std::optional(line);
  }
}

Result<void> TextReader::parse(std::string_view line, PointBatch& batch) {
  split_cells(line, start_.layout.separator, cells_);
  if (cells_.size() != axes_.size())
    return lines_.error(fmt::format("found {} values, expected {}", cells_.size(), axes_.size()));
  World3 position{};
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    double value = 0;
    const NumberFault fault = parse_number(cells_[i], value);
    if (fault != NumberFault::kNone) return wrong_number(i, fault);
    if (axes_[i]) {
      position[*axes_[i]] = value;
    } else {
      const auto bytes = std::as_bytes(std::span(&value, 1));
      batch.rows.insert(batch.rows.end(), bytes.begin(), bytes.end());
    }
  }
  batch.world.push_back(position);
  return {};
}

Error TextReader::wrong_number(std::size_t column, NumberFault fault) const {
  return lines_.error(fmt::format("found {} in column '{}', which {}", in_quotes(cells_[column]),
                                  start_.layout.columns[column], describe(fault, Type::kFloat64)));
}

Result<void> TextReader::check_end() const {
  if (!start_.count || next_ == *start_.count) return {};
  return Error{Fault::kBadInput,
               fmt::format("{}: the file ends at offset {} after {} points, but its count line "
                           "promises {}; the file is cut short or the count is wrong",
                           lines_.path(), lines_.size(), next_, *start_.count)};
}

Result<void> TextReader::seek(std::uint64_t record) {
  if (record < next_) {
    lines_.go_to(start_.points);
    next_ = 0;
  }
  for (; next_ < record; ++next_) {
    PSS_ASSIGN(const std::optional<std::string_view> line, next_point());
    if (!line)
      return Error{Fault::kBadInput, fmt::format("{}: has {} points, but point {} was asked for",
                                                 lines_.path(), next_, record)};
  }
  return {};
}

Result<void> check_count(const LineSource& lines, const TextStart& start) {
  const std::uint64_t most = (lines.size() - start.points.offset + 1) / kShortestPoint;
  if (!start.count || *start.count <= most) return {};
  return Error{Fault::kBadInput,
               fmt::format("{}: the count line promises {} points, but after it (offset {}) the "
                           "file has room for at most {}; the file is cut short or the count is "
                           "wrong",
                           lines.path(), *start.count, start.points.offset, most)};
}

}  // namespace

Result<std::unique_ptr<Reader>> open_text(const std::string& path) {
  PSS_ASSIGN(ByteSource bytes, ByteSource::open(path));
  LineSource lines(std::move(bytes));
  PSS_ASSIGN(TextStart start, detect_text(lines));
  PSS_TRY(check_count(lines, start));
  return std::unique_ptr<Reader>(std::make_unique<TextReader>(std::move(lines), std::move(start)));
}

}  // namespace pss
