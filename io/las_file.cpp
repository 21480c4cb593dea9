#include "io/las_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace pss {
namespace {

/// A damaged file can promise no more than this; real ones have a handful.
constexpr std::uint32_t kMostEvlrs = 100000;

void check_vlrs(LasHead& head) {
  const std::size_t found = head.vlrs.size();
  if (found < head.header.vlr_count)
    head.warnings.push_back(fmt::format(
        "found {} VLRs that lie whole before the points at offset {}, expected {}; the others are "
        "kept as bytes but not understood",
        found, head.header.point_offset, head.header.vlr_count));
}

void check_counts(LasHead& head) {
  const LasHeader& h = head.header;
  if (h.has_evlrs() && h.count != 0 && h.legacy_count != 0 && h.count != h.legacy_count)
    head.warnings.push_back(
        fmt::format("the header has {} points, and {} in its legacy field; "
                    "the first is taken",
                    h.count, h.legacy_count));
}

/// Says what lies behind the points and is not read.
void check_rest(const LasHeader& header, std::uint64_t size, std::vector<std::string>& warnings) {
  if (header.has_evlrs() && header.evlr_count > 0) return;
  if (header.wave_offset != 0 || header.end_of_points() >= size) return;
  warnings.push_back(
      fmt::format("{} bytes behind the last point belong to nothing and are "
                  "ignored{}",
                  size - header.end_of_points(),
                  header.points() == 0 ? "; the header promises no points" : ""));
}

Error past_end(const File& file, std::uint64_t offset, std::uint64_t length, std::uint64_t size) {
  return {Fault::kBadInput, fmt::format("{}: EVLR at offset {}: expected {} bytes, found the "
                                        "file's end at {}; it is cut short or damaged",
                                        file.path(), offset, length, size)};
}

/// Whether [offset, offset + length) lies within `size` bytes.
bool within(std::uint64_t offset, std::uint64_t length, std::uint64_t size) {
  return offset <= size && length <= size - offset;
}

/// Appends the EVLR at `offset` to `tail`, or says why not; returns where the next one is.
Result<std::uint64_t> add_evlr(const File& file, std::uint64_t offset, std::uint64_t size,
                               std::vector<std::byte>& tail, std::vector<std::string>& warnings) {
  if (!within(offset, kEvlrHeader, size)) return past_end(file, offset, kEvlrHeader, size);
  std::array<std::byte, kEvlrHeader> bytes;
  PSS_TRY(file.read(offset, bytes));
  const EvlrHeader evlr = load_evlr_header(bytes);
  if (!within(offset + kEvlrHeader, evlr.length, size))
    return past_end(file, offset + kEvlrHeader, evlr.length, size);
  const std::uint64_t whole = kEvlrHeader + evlr.length;
  const char* why = reason_to_drop(evlr.user_id, evlr.record_id);
  if (!why && whole > kLasLargestCarry - tail.size()) why = "it is too large to be carried on";
  if (why) {
    warnings.push_back(
        fmt::format("EVLR '{}' {} is dropped: {}", evlr.user_id, evlr.record_id, why));
  } else {
    tail.resize(tail.size() + whole);
    PSS_TRY(file.read(offset, std::span(tail).last(whole)));
  }
  return offset + whole;
}

}  // namespace

Result<LasHead> parse_las_head(std::vector<std::byte> bytes, const std::string& path,
                               std::uint64_t file_size) {
  if (!is_las(bytes) || bytes.size() < kLasSmallestHeader)
    return Error{Fault::kBadInput,
                 fmt::format("{}: offset 0: found {} bytes, expected a LAS header of at least {}",
                             path, bytes.size(), kLasSmallestHeader)};
  LasHead head;
  head.header = load_las_header(bytes);
  PSS_TRY(check_las_header(head.header, path, file_size));
  head.bytes = std::move(bytes);
  head.vlrs = list_vlrs(head.bytes, head.header.header_size, head.header.vlr_count);
  const std::size_t extra_size =
      head.header.record_length - las_record_size(head.header.point_format);
  head.extra = read_extra_fields(extra_descriptors(head.vlrs, head.bytes), extra_size,
                                 las_standard_schema(head.header.point_format), head.warnings);
  check_vlrs(head);
  check_counts(head);
  return head;
}

Result<LasHead> read_las_head(const File& file) {
  PSS_ASSIGN(const std::uint64_t size, file.size());
  std::vector<std::byte> bytes(kLas14Header);
  PSS_ASSIGN(const std::size_t got, file.read_some(0, bytes));
  bytes.resize(got);
  if (!is_las(bytes) || got < kLasSmallestHeader) return parse_las_head(bytes, file.path(), size);
  const LasHeader header = load_las_header(bytes);
  PSS_TRY(check_las_header(header, file.path(), size));
  if (header.point_offset > kLasLargestCarry)
    return Error{
        Fault::kBadInput,
        fmt::format("{}: LAS header, offset 96: found {} bytes before the points, expected "
                    "at most {}",
                    file.path(), header.point_offset, kLasLargestCarry)};
  bytes.resize(header.point_offset);
  PSS_TRY(file.read(0, bytes));
  return parse_las_head(std::move(bytes), file.path(), size);
}

Result<std::vector<std::byte>> read_las_tail(const File& file, const LasHeader& header,
                                             std::vector<std::string>& warnings) {
  PSS_ASSIGN(const std::uint64_t size, file.size());
  check_rest(header, size, warnings);
  if (header.has_wave_offset() && header.wave_offset != 0)
    warnings.push_back("waveform data packets are not carried on; the points keep their fields");
  const std::uint32_t count = header.has_evlrs() ? header.evlr_count : 0;
  if (count > kMostEvlrs)
    return Error{Fault::kBadInput, fmt::format("{}: LAS header, offset 243: found {} EVLRs, "
                                               "expected at most {}",
                                               file.path(), count, kMostEvlrs)};
  std::vector<std::byte> tail;
  std::uint64_t offset = header.evlr_offset;
  for (std::uint32_t i = 0; i < count; ++i) {
    PSS_ASSIGN(offset, add_evlr(file, offset, size, tail, warnings));
  }
  return tail;
}

}  // namespace pss
