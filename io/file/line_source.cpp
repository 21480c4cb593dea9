#include "io/file/line_source.h"

#include <fmt/format.h>

#include <span>

namespace pss {
namespace {

constexpr std::size_t kLongestLine = std::size_t{1} << 20;
/// A piece that holds most lines at once.
constexpr std::size_t kUsualLine = 256;

bool is_end(std::byte b) { return b == std::byte{'\n'} || b == std::byte{'\r'}; }

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r'; }

std::size_t find_end(std::span<const std::byte> bytes, std::size_t from) {
  while (from < bytes.size() && !is_end(bytes[from])) ++from;
  return from;
}

/// A "\r" that ends the piece may be half of "\r\n".
bool is_complete(std::span<const std::byte> bytes, std::size_t end) {
  return end + 1 < bytes.size() || (end < bytes.size() && bytes[end] == std::byte{'\n'});
}

std::size_t end_width(std::span<const std::byte> bytes, std::size_t end) {
  if (end == bytes.size()) return 0;
  const bool two =
      bytes[end] == std::byte{'\r'} && end + 1 < bytes.size() && bytes[end + 1] == std::byte{'\n'};
  return two ? 2 : 1;
}

}  // namespace

Result<std::optional<std::string_view>> LineSource::next() {
  start_ = bytes_.offset();
  std::size_t length = 0;
  std::size_t wanted = kUsualLine;
  for (;;) {
    PSS_ASSIGN(const std::span<const std::byte> bytes, bytes_.peek(wanted));
    if (bytes.empty()) return std::optional<std::string_view>();
    length = find_end(bytes, length);
    if (length > kLongestLine) return too_long();
    if (bytes.size() < wanted || is_complete(bytes, length)) {
      ++line_;
      bytes_.skip(length + end_width(bytes, length));
      return std::optional(std::string_view(reinterpret_cast<const char*>(bytes.data()), length));
    }
    wanted = 2 * bytes.size();
  }
}

Error LineSource::too_long() {
  ++line_;
  return error("the line is longer than 1 MiB; this is no text file of points");
}

void LineSource::go_to(const LinePlace& place) {
  bytes_.seek(place.offset);
  line_ = place.line;
}

Error LineSource::error(std::string_view message) const {
  return {Fault::kBadInput,
          fmt::format("{}: line {} (offset {}): {}", path(), line_, start_, message)};
}

std::string_view next_token(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view token = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return token;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace pss
