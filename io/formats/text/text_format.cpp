#include "io/formats/text/text_format.h"

#include <algorithm>
#include <array>

#include "io/formats/text/text_plan.h"
#include "io/formats/text/text_reader.h"
#include "io/formats/text/text_writer.h"

namespace pss {
namespace {

constexpr std::array<std::string_view, 5> kExtensions{"xyz", "txt", "csv", "asc", "pts"};

/// Text has no control characters but those that break lines and columns.
Likeness probe(std::string_view start) {
  const bool is_text = std::ranges::all_of(start, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7F) || c == '\n' || c == '\r' || c == '\t' || c == '\f';
  });
  return is_text ? Likeness::kPossible : Likeness::kNone;
}

Result<std::unique_ptr<Reader>> open(HeadBytes /*bytes*/, const std::string& path) {
  return open_text(path);  // heads are small
}

Result<std::unique_ptr<Writer>> create(const std::string& path, WriteOptions options) {
  return create_text(path, options);
}

Result<std::optional<Lattice>> plan(const std::string& path, WriteOptions options) {
  PSS_TRY(plan_text(path, options));
  return std::nullopt;
}

}  // namespace

constinit const Format kTextFormat{.name = "text",
                                   .extensions = kExtensions,
                                   .probe = probe,
                                   .open = open,
                                   .create = create,
                                   .plan = plan,
                                   .family = "text",
                                   .bytes_factor = 3};  // digits take about three times the bytes

}  // namespace pss
