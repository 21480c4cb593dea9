// The ascii half of io/formats/ply/ply_bodies.h.

#include <fmt/format.h>

#include <array>
#include <utility>

#include "io/file/line_source.h"
#include "io/formats/ply/ply_bodies.h"
#include "io/points/numbers.h"

namespace pss {
namespace {

/// The next line that is not blank.
Result<std::optional<std::string_view>> next_entry(LineSource& lines) {
  for (;;) {
    PSS_ASSIGN(const std::optional<std::string_view> line, lines.next());
    if (!line || !trimmed(*line).empty()) return line;
  }
}

/// Goes on by `count` lines; the number passed is smaller only at the end of the file.
Result<std::uint64_t> skip_entries(LineSource& lines, std::uint64_t count) {
  for (std::uint64_t passed = 0; passed < count; ++passed) {
    PSS_ASSIGN(const std::optional<std::string_view> line, next_entry(lines));
    if (!line) return passed;
  }
  return count;
}

class PlyTextReader final : public PlyReader {
 public:
  PlyTextReader(PlyFile file, LineSource lines)
      : PlyReader(std::move(file)), lines_(std::move(lines)), start_(lines_.place()) {}

 protected:
  Result<void> fill(PointBatch& batch) override;
  Result<void> go_to(std::uint64_t record) override;

 private:
  Result<void> parse(std::string_view line, World3& position, std::byte* row);
  Result<void> parse_value(std::size_t property, std::string_view& rest, World3& position,
                           std::byte* row);
  Result<void> skip_list(std::size_t property, std::string_view length, std::string_view& rest);
  Error too_few(std::size_t property);

  LineSource lines_;
  LinePlace start_;  ///< of the first vertex
};

Result<void> PlyTextReader::fill(PointBatch& batch) {
  const std::size_t row_size = file().layout.schema.row_size();
  for (std::size_t i = 0; i < batch.world.size(); ++i) {
    PSS_ASSIGN(const std::optional<std::string_view> line, next_entry(lines_));
    if (!line) return short_of(next() + i);
    PSS_TRY(parse(*line, batch.world[i], batch.rows.data() + i * row_size));
  }
  return {};
}

Result<void> PlyTextReader::parse(std::string_view line, World3& position, std::byte* row) {
  const std::size_t count = file().layout.slots.size();
  for (std::size_t i = 0; i < count; ++i) PSS_TRY(parse_value(i, line, position, row));
  if (const std::string_view extra = next_token(line); !extra.empty())
    return lines_.error(
        fmt::format("found {} behind the last of {} properties, expected the end "
                    "of the line",
                    in_quotes(extra), count));
  return {};
}

Result<void> PlyTextReader::parse_value(std::size_t property, std::string_view& rest,
                                        World3& position, std::byte* row) {
  const PlySlot& slot = file().layout.slots[property];
  const std::string_view token = next_token(rest);
  if (token.empty()) return too_few(property);
  if (slot.length_type) return skip_list(property, token, rest);
  std::array<std::byte, 8> value;
  const NumberFault fault = parse_number(token, slot.type, value.data());
  if (fault != NumberFault::kNone)
    return lines_.error(fmt::format("found {} for property '{}', which {}", in_quotes(token),
                                    file().vertices().properties[property].name,
                                    describe(fault, slot.type)));
  place_value(slot, value.data(), position, row);
  return {};
}

Result<void> PlyTextReader::skip_list(std::size_t property, std::string_view length,
                                      std::string_view& rest) {
  double count = 0;
  if (parse_number(length, count) != NumberFault::kNone || !(count >= 0))
    return lines_.error("found " + in_quotes(length) + " as the length of a list");
  for (double i = 0; i < count; ++i)
    if (next_token(rest).empty()) return too_few(property);
  return {};
}

Error PlyTextReader::too_few(std::size_t property) {
  return lines_.error(fmt::format("the line ends before property {} of {}", property + 1,
                                  file().layout.slots.size()));
}

Result<void> PlyTextReader::go_to(std::uint64_t record) {
  if (record < next()) lines_.go_to(start_);
  const std::uint64_t from = record < next() ? 0 : next();
  PSS_ASSIGN(const std::uint64_t passed, skip_entries(lines_, record - from));
  if (passed < record - from) return short_of(from + passed);
  return {};
}

}  // namespace

Result<std::unique_ptr<Reader>> read_ply_text(PlyFile file) {
  LineSource lines(std::move(file.bytes));
  lines.go_to({file.header.size, file.header.lines});
  for (std::size_t i = 0; i < file.vertex; ++i) {
    const PlyElement& element = file.header.elements[i];
    if (element.properties.empty()) continue;
    PSS_ASSIGN(const std::uint64_t passed, skip_entries(lines, element.count));
    if (passed < element.count)
      return lines.error(
          fmt::format("the file ends after {} entries of element '{}', but its "
                      "header promises {}",
                      passed, element.name, element.count));
  }
  return std::unique_ptr<Reader>(
      std::make_unique<PlyTextReader>(std::move(file), std::move(lines)));
}

}  // namespace pss
