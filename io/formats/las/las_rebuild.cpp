#include "io/formats/las/las_rebuild.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace pss {
namespace {

/// The header block in the shape of another minor version: new fields are zero.
std::vector<std::byte> grown_header(const LasHead& head, std::uint8_t minor) {
  const std::size_t before = head.header.minor >= 4   ? kLas14Header
                             : head.header.minor == 3 ? kLas13Header
                                                      : kLasSmallestHeader;
  const std::size_t after = minor >= 4 ? kLas14Header : kLas13Header;
  const auto from = head.bytes.begin();
  const std::size_t known = std::min<std::size_t>(before, head.header.header_size);
  std::vector<std::byte> bytes(from, from + static_cast<std::ptrdiff_t>(known));
  bytes.resize(after);
  bytes.insert(bytes.end(), from + static_cast<std::ptrdiff_t>(known),
               from + head.header.header_size);
  return bytes;
}

std::vector<std::byte> extra_vlr(const std::vector<ExtraField>& extra) {
  std::vector<std::byte> descriptors;
  for (const ExtraField& e : extra) append_descriptors(e, descriptors);
  return descriptors;
}

}  // namespace

void raise_version(LasHead& head, std::uint8_t minor, std::vector<std::string>& notes) {
  if (minor <= head.header.minor) return;
  notes.push_back(fmt::format("the file becomes LAS 1.{}, from 1.{}", minor, head.header.minor));
  if (minor >= 3) {
    std::vector<std::byte> bytes = grown_header(head, minor);
    const std::size_t old_size = head.header.header_size;
    const std::size_t growth = bytes.size() - old_size;
    bytes.insert(bytes.end(), head.bytes.begin() + static_cast<std::ptrdiff_t>(old_size),
                 head.bytes.end());
    head.header.header_size = static_cast<std::uint16_t>(old_size + growth);
    head.bytes = std::move(bytes);
  }
  head.header.minor = minor;
}

Result<void> rebuild_vlrs(LasHead& head, bool new_extra, const std::string& path) {
  std::vector<std::byte> bytes;
  bytes.reserve(head.bytes.size() + kVlrHeader + std::numeric_limits<std::uint16_t>::max());
  bytes.assign(head.bytes.begin(), head.bytes.begin() + head.header.header_size);
  std::uint32_t count = 0;
  std::size_t end = head.header.header_size;
  for (const Vlr& vlr : head.vlrs()) {
    end = vlr.end();
    if (reason_to_drop(vlr.user_id, vlr.record_id)) continue;
    if (new_extra && vlr.is("LASF_Spec", kExtraBytesRecord)) continue;
    const auto whole = std::span(head.bytes).subspan(vlr.position, vlr.end() - vlr.position);
    bytes.insert(bytes.end(), whole.begin(), whole.end());
    ++count;
  }
  const std::vector<std::byte> descriptors = extra_vlr(head.extra);
  if (descriptors.size() > std::numeric_limits<std::uint16_t>::max())
    return Error{Fault::kBadInput,
                 fmt::format("{}: found {} attributes beyond the point format, expected at most "
                             "341, which is what LAS can describe",
                             path, head.extra.size())};
  if (new_extra && !descriptors.empty()) {
    const auto vlr = make_vlr("LASF_Spec", kExtraBytesRecord, "Extra bytes", descriptors);
    bytes.insert(bytes.end(), vlr.begin(), vlr.end());
    ++count;
  }
  bytes.insert(bytes.end(), head.bytes.begin() + static_cast<std::ptrdiff_t>(end),
               head.bytes.end());
  head.header.vlr_count = count;
  head.bytes = std::move(bytes);
  return {};
}

bool drops_vlrs(const LasHead& head, std::vector<std::string>& notes) {
  DropNotes dropped("VLR");
  for (const Vlr& vlr : head.vlrs())
    if (const char* why = reason_to_drop(vlr.user_id, vlr.record_id))
      dropped.add(vlr.user_id, vlr.record_id, why, notes);
  dropped.finish(notes);
  return dropped.any();
}

}  // namespace pss
