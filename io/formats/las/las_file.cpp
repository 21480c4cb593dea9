#include "io/formats/las/las_file.h"

#include <fmt/format.h>

#include <utility>

#include "io/formats/las/las_evlrs.h"
#include "io/formats/las/las_format.h"

namespace pss {
namespace {

void check_vlrs(LasHead& head, std::size_t found) {
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

}  // namespace

Result<LasHeader> understood_las_header(std::span<const std::byte> bytes, const std::string& path,
                                        std::uint64_t file_size) {
  if (!is_las(bytes) || bytes.size() < kLasSmallestHeader)
    return Error{Fault::kBadInput,
                 fmt::format("{}: offset 0: found {} bytes, expected a LAS header of at least {}",
                             path, bytes.size(), kLasSmallestHeader)};
  const LasHeader header = load_las_header(bytes);
  PSS_TRY(check_las_header(header, path, file_size));
  return header;
}

LasHead las_head(const LasHeader& header, std::vector<std::byte> bytes, std::size_t vlrs) {
  LasHead head;
  head.header = header;
  head.bytes = std::move(bytes);
  const std::size_t extra_size = header.record_length - las_record_size(header.point_format);
  head.extra = read_extra_fields(extra_descriptors(head.vlrs(), head.bytes), extra_size,
                                 las_standard_schema(header.point_format), head.warnings);
  check_vlrs(head, vlrs);
  check_counts(head);
  return head;
}

Result<LasHead> parse_las_head(std::vector<std::byte> bytes, const std::string& path,
                               std::uint64_t file_size) {
  PSS_ASSIGN(const LasHeader header, understood_las_header(bytes, path, file_size));
  const std::size_t vlrs = list_vlrs(bytes, header.header_size, header.vlr_count).size();
  return las_head(header, std::move(bytes), vlrs);
}

Result<Carry> read_las_carry(const File& file, const LasHeader& header, std::uint64_t tail_size) {
  Carry carry{std::string(kLasFormat.family), std::vector<std::byte>(header.point_offset), {}};
  PSS_TRY(file.read(0, carry.head));
  carry.tail.reserve(static_cast<std::size_t>(tail_size));
  PSS_TRY(for_each_evlr(file, header, [&](const Evlr& evlr) -> Result<void> {
    if (evlr.why_dropped || carry.tail.size() + evlr.size() > tail_size) return {};
    carry.tail.resize(carry.tail.size() + static_cast<std::size_t>(evlr.size()));
    return file.read(evlr.offset,
                     std::span(carry.tail).last(static_cast<std::size_t>(evlr.size())));
  }));
  return carry;
}

}  // namespace pss
