#include "io/formats/ply/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "io/file/line_source.h"
#include "io/points/numbers.h"

namespace pss {
namespace {

struct Word {
  std::string_view word;
  Type type;
};

constexpr std::array<Word, 16> kTypeWords{{{"char", Type::kInt8},
                                           {"uchar", Type::kUint8},
                                           {"short", Type::kInt16},
                                           {"ushort", Type::kUint16},
                                           {"int", Type::kInt32},
                                           {"uint", Type::kUint32},
                                           {"float", Type::kFloat32},
                                           {"double", Type::kFloat64},
                                           {"int8", Type::kInt8},
                                           {"uint8", Type::kUint8},
                                           {"int16", Type::kInt16},
                                           {"uint16", Type::kUint16},
                                           {"int32", Type::kInt32},
                                           {"uint32", Type::kUint32},
                                           {"float32", Type::kFloat32},
                                           {"float64", Type::kFloat64}}};

struct EncodingWord {
  std::string_view word;
  PlyEncoding encoding;
};

constexpr std::array<EncodingWord, 3> kEncodingWords{
    {{"ascii", PlyEncoding::kAscii},
     {"binary_little_endian", PlyEncoding::kLittleEndian},
     {"binary_big_endian", PlyEncoding::kBigEndian}}};

/// Takes a header apart line by line.
class Parser {
 public:
  Parser(std::string_view head, const std::string& path) : head_(head), path_(path) {}

  Result<PlyHeader> parse();

 private:
  Result<std::string_view> next_line();
  Result<bool> parse_line(std::string_view line);  ///< true at the end
  Result<void> parse_keyword(std::string_view keyword, std::string_view rest);
  Result<void> parse_format(std::string_view rest);
  Result<void> parse_element(std::string_view rest);
  Result<void> parse_property(std::string_view rest);
  Result<Type> parse_type(std::string_view word) const;
  Result<void> check_property(const PlyProperty& property);
  void choose_line_end();

  Error error(std::string_view message) const {
    return {Fault::kBadInput,
            fmt::format("{}: line {} of the PLY header: {}", path_, header_.lines, message)};
  }

  std::string_view head_;
  const std::string& path_;
  PlyHeader header_;
  char line_end_ = '\n';
  bool has_format_ = false;
  std::size_t properties_ = 0;
};

Result<PlyHeader> Parser::parse() {
  choose_line_end();
  PSS_ASSIGN(const std::string_view magic, next_line());
  if (trimmed(magic) != "ply") return error("found " + in_quotes(magic) + ", expected 'ply'");
  for (bool done = false; !done;) {
    PSS_ASSIGN(const std::string_view line, next_line());
    PSS_ASSIGN(done, parse_line(trimmed(line)));
  }
  if (!has_format_) return error("no 'format' line before 'end_header'");
  return std::move(header_);
}

/// Binary data may begin with a "\n", so a header of "\r" lines must not take it as its own.
void Parser::choose_line_end() {
  const std::size_t end = head_.find_first_of("\r\n");
  const bool lone = end != std::string_view::npos && head_[end] == '\r' && end + 1 < head_.size() &&
                    head_[end + 1] != '\n';
  line_end_ = lone ? '\r' : '\n';
}

Result<std::string_view> Parser::next_line() {
  ++header_.lines;
  const std::size_t end = head_.find(line_end_, header_.size);
  if (end != std::string_view::npos) {
    const std::string_view line = head_.substr(header_.size, end - header_.size);
    header_.size = end + 1;
    return line;
  }
  // A file without points may end right behind the word.
  const std::string_view last = head_.substr(header_.size);
  header_.size = head_.size();
  if (head_.size() < kPlyHeaderLimit && trimmed(last) == "end_header") return last;
  return error(fmt::format("no 'end_header' in the first {} bytes; this is no whole PLY file",
                           head_.size()));
}

Result<bool> Parser::parse_line(std::string_view line) {
  std::string_view rest = line;
  const std::string_view keyword = next_token(rest);
  if (keyword == "end_header") return true;
  if (keyword == "comment" || keyword == "obj_info") header_.comments.emplace_back(line);
  if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) return false;
  PSS_TRY(parse_keyword(keyword, rest));
  return false;
}

Result<void> Parser::parse_keyword(std::string_view keyword, std::string_view rest) {
  if (keyword == "format") return parse_format(rest);
  if (keyword == "element") return parse_element(rest);
  if (keyword == "property") return parse_property(rest);
  return error("found " + in_quotes(keyword) +
               ", expected format, comment, obj_info, element, property or end_header");
}

Result<void> Parser::parse_format(std::string_view rest) {
  const std::string_view word = next_token(rest);
  const std::string_view version = next_token(rest);
  const auto known = std::ranges::find(kEncodingWords, word, &EncodingWord::word);
  if (known == kEncodingWords.end() || version != "1.0" || !trimmed(rest).empty())
    return error("found " + in_quotes(word) + " " + in_quotes(version) +
                 ", expected ascii, binary_little_endian or binary_big_endian and 1.0");
  header_.encoding = known->encoding;
  has_format_ = true;
  return {};
}

Result<void> Parser::parse_element(std::string_view rest) {
  PlyElement element;
  element.name = next_token(rest);
  const std::string_view count = next_token(rest);
  const auto [end, fault] =
      std::from_chars(count.data(), count.data() + count.size(), element.count);
  if (fault != std::errc{} || end != count.data() + count.size() || !trimmed(rest).empty())
    return error("found count " + in_quotes(count) + " of element " + in_quotes(element.name) +
                 ", expected one number from 0 to 2^64 - 1");
  if (header_.elements.size() == kPlyPropertyLimit)
    return error(fmt::format("more than {} elements", kPlyPropertyLimit));
  if (header_.find(element.name))
    return error("element " + in_quotes(element.name) + " comes twice");
  header_.elements.push_back(std::move(element));
  return {};
}

Result<void> Parser::parse_property(std::string_view rest) {
  PlyProperty property;
  property.spelling = next_token(rest);
  if (property.spelling == "list") {
    property.length_spelling = next_token(rest);
    PSS_ASSIGN(property.length_type, parse_type(property.length_spelling));
    property.spelling = next_token(rest);
  }
  PSS_ASSIGN(property.type, parse_type(property.spelling));
  property.name = next_token(rest);
  if (property.name.empty() || !trimmed(rest).empty())
    return error("a property needs a type and one name");
  PSS_TRY(check_property(property));
  header_.elements.back().properties.push_back(std::move(property));
  return {};
}

Result<Type> Parser::parse_type(std::string_view word) const {
  const auto known = std::ranges::find(kTypeWords, word, &Word::word);
  if (known == kTypeWords.end())
    return error("found type " + in_quotes(word) +
                 ", expected char, uchar, short, ushort, int, uint, float or double");
  return known->type;
}

Result<void> Parser::check_property(const PlyProperty& property) {
  if (header_.elements.empty()) return error("a property before the first element");
  if (++properties_ > kPlyPropertyLimit)
    return error(fmt::format("more than {} properties", kPlyPropertyLimit));
  if (property.length_type && is_float(*property.length_type))
    return error("a list's length cannot be of type " + in_quotes(property.length_spelling));
  const auto& others = header_.elements.back().properties;
  if (std::ranges::find(others, property.name, &PlyProperty::name) != others.end())
    return error("property " + in_quotes(property.name) + " comes twice");
  return {};
}

std::string property_line(const PlyProperty& property) {
  const std::string list = property.length_type ? "list " + property.length_spelling + " " : "";
  return fmt::format("property {}{} {}\n", list, property.spelling, property.name);
}

}  // namespace

std::optional<std::size_t> PlyHeader::find(std::string_view name) const {
  const auto found = std::ranges::find(elements, name, &PlyElement::name);
  if (found == elements.end()) return std::nullopt;
  return static_cast<std::size_t>(found - elements.begin());
}

Result<PlyHeader> parse_ply_header(std::string_view head, const std::string& path) {
  return Parser(head.substr(0, kPlyHeaderLimit), path).parse();
}

std::string format_ply_header(const PlyHeader& header) {
  const auto encoding = std::ranges::find(kEncodingWords, header.encoding, &EncodingWord::encoding);
  std::string text = fmt::format("ply\nformat {} 1.0\n", encoding->word);
  for (const std::string& comment : header.comments) text += comment + "\n";
  for (const PlyElement& element : header.elements) {
    text += fmt::format("element {} {}\n", element.name, element.count);
    for (const PlyProperty& property : element.properties) text += property_line(property);
  }
  return text + "end_header\n";
}

std::optional<std::string_view> ply_type_name(Type type) {
  const auto known = std::ranges::find(kTypeWords, type, &Word::type);
  if (known == kTypeWords.end()) return std::nullopt;
  return known->word;
}

std::size_t least_size(const PlyElement& element) {
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties)
    size += size_of(property.length_type.value_or(property.type));
  return size;
}

bool has_lists(const PlyElement& element) {
  return std::ranges::any_of(element.properties,
                             [](const PlyProperty& p) { return p.length_type.has_value(); });
}

}  // namespace pss
