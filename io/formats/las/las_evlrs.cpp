#include "io/formats/las/las_evlrs.h"

#include <fmt/format.h>

#include <array>

#include "io/formats/las/las_file.h"

namespace pss {
namespace {

/// A damaged file can promise no more than this; real ones have a handful.
constexpr std::uint32_t kMostEvlrs = 100000;

Error past_end(const File& file, std::uint64_t offset, std::uint64_t length, std::uint64_t size) {
  return {Fault::kBadInput, fmt::format("{}: EVLR at offset {}: expected {} bytes, found the "
                                        "file's end at {}; it is cut short or damaged",
                                        file.path(), offset, length, size)};
}

/// Whether [offset, offset + length) lies within `size` bytes.
bool within(std::uint64_t offset, std::uint64_t length, std::uint64_t size) {
  return offset <= size && length <= size - offset;
}

/// The EVLR at `offset`, where `carried` bytes of those before it are carried on.
Result<Evlr> evlr_at(const File& file, std::uint64_t offset, std::uint64_t size,
                     std::uint64_t carried) {
  if (!within(offset, kEvlrHeader, size)) return past_end(file, offset, kEvlrHeader, size);
  std::array<std::byte, kEvlrHeader> bytes;
  PSS_TRY(file.read(offset, bytes));
  Evlr evlr{load_evlr_header(bytes), offset, nullptr};
  if (!within(offset + kEvlrHeader, evlr.header.length, size))
    return past_end(file, offset + kEvlrHeader, evlr.header.length, size);
  evlr.why_dropped = reason_to_drop(evlr.header.user_id, evlr.header.record_id);
  if (!evlr.why_dropped && evlr.size() > kLasLargestCarry - carried)
    evlr.why_dropped = "it is too large to be carried on";
  return evlr;
}

}  // namespace

Result<void> for_each_evlr(const File& file, const LasHeader& header,
                           const std::function<Result<void>(const Evlr&)>& visit) {
  const std::uint32_t count = header.has_evlrs() ? header.evlr_count : 0;
  if (count == 0) return {};
  if (count > kMostEvlrs)
    return Error{Fault::kBadInput, fmt::format("{}: LAS header, offset 243: found {} EVLRs, "
                                               "expected at most {}",
                                               file.path(), count, kMostEvlrs)};
  PSS_ASSIGN(const std::uint64_t size, file.size());
  std::uint64_t offset = header.evlr_offset;
  std::uint64_t carried = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    PSS_ASSIGN(const Evlr evlr, evlr_at(file, offset, size, carried));
    if (!evlr.why_dropped) carried += evlr.size();
    PSS_TRY(visit(evlr));
    offset += evlr.size();
  }
  return {};
}

void note_las_rest(const LasHeader& header, std::uint64_t file_size,
                   std::vector<std::string>& warnings) {
  if (header.has_wave_offset() && header.wave_offset != 0)
    warnings.push_back("waveform data packets are not carried on; the points keep their fields");
  if (header.has_evlrs() && header.evlr_count > 0) return;
  if (header.wave_offset != 0 || header.end_of_points() >= file_size) return;
  warnings.push_back(
      fmt::format("{} bytes behind the last point belong to nothing and are "
                  "ignored{}",
                  file_size - header.end_of_points(),
                  header.points() == 0 ? "; the header promises no points" : ""));
}

}  // namespace pss
