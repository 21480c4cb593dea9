#include "io/formats/las/las_facts.h"

#include <fmt/format.h>

#include "io/formats/las/las_header.h"
#include "io/formats/las/las_vlr.h"

namespace pss {
namespace {

void add_parts(const VlrRange& vlrs, std::vector<FilePart>& parts) {
  for (const Vlr& vlr : vlrs)
    parts.push_back({vlr.user_id, std::to_string(vlr.record_id), vlr.length});
}

}  // namespace

std::vector<Fact> las_facts(const Carry& carry) {
  if (carry.head.size() < kLasSmallestHeader) return {};
  const LasHeader header = load_las_header(carry.head);
  std::vector<FilePart> vlrs;
  add_parts(list_vlrs(carry.head, header.header_size, header.vlr_count), vlrs);
  add_parts(list_evlrs(carry.tail), vlrs);
  const auto number = [](std::uint64_t value) { return value; };
  return {{"las_version", fmt::format("{}.{}", header.major, header.minor)},
          {"point_format", number(header.point_format)},
          {"record_bytes", number(header.record_length)},
          {"vlrs", std::move(vlrs)}};
}

}  // namespace pss
