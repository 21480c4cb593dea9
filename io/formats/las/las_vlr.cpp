#include "io/formats/las/las_vlr.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <optional>

#include "io/file/bytes.h"

namespace pss {
namespace {

// VLR:  0 reserved u16, 2 user id 16 bytes, 18 record id u16, 20 length u16, 22 description 32.
// EVLR: the same with length u64, so the description starts at 28.
constexpr std::size_t kUserId = 2;
constexpr std::size_t kRecordId = 18;
constexpr std::size_t kLength = 20;
constexpr std::size_t kVlrDescription = 22;
/// Dropped records that are named each.
constexpr std::size_t kMostNamed = 16;

std::optional<Vlr> vlr_at(std::span<const std::byte> bytes, std::size_t position,
                          std::size_t header_size) {
  if (position > bytes.size() || bytes.size() - position < header_size) return std::nullopt;
  const auto header = bytes.subspan(position, header_size);
  const std::uint64_t length = header_size == kVlrHeader ? load_le<std::uint16_t>(header, kLength)
                                                         : load_le<std::uint64_t>(header, kLength);
  if (length > bytes.size() - position - header_size) return std::nullopt;
  return Vlr{text_in(header.subspan(kUserId, 16)), load_le<std::uint16_t>(header, kRecordId),
             position, header_size, static_cast<std::size_t>(length)};
}

void put_text(std::span<std::byte> field, std::string_view text) {
  std::memcpy(field.data(), text.data(), std::min(text.size(), field.size()));
}

}  // namespace

std::span<const std::byte> payload(const Vlr& vlr, std::span<const std::byte> bytes) {
  return bytes.subspan(vlr.position + vlr.header_size, vlr.length);
}

VlrRange::Iterator::Iterator(const VlrRange& range, std::size_t position) : range_(&range) {
  look(position);
}

VlrRange::Iterator& VlrRange::Iterator::operator++() {
  ++number_;
  look(vlr_->end());
  return *this;
}

void VlrRange::Iterator::look(std::size_t position) {
  vlr_ = number_ < range_->most_ ? vlr_at(range_->bytes_, position, range_->header_size_)
                                 : std::nullopt;
}

std::size_t VlrRange::size() const {
  std::size_t count = 0;
  for (auto at = begin(); at != end(); ++at) ++count;
  return count;
}

VlrRange list_vlrs(std::span<const std::byte> head, std::size_t header_size, std::uint32_t count) {
  return {head, header_size, kVlrHeader, count};
}

VlrRange list_evlrs(std::span<const std::byte> tail) { return {tail, 0, kEvlrHeader, tail.size()}; }

VlrHeader load_vlr_header(std::span<const std::byte> bytes) {
  return {text_in(bytes.subspan(kUserId, 16)), load_le<std::uint16_t>(bytes, kRecordId),
          load_le<std::uint16_t>(bytes, kLength)};
}

VlrHeader load_evlr_header(std::span<const std::byte> bytes) {
  return {text_in(bytes.subspan(kUserId, 16)), load_le<std::uint16_t>(bytes, kRecordId),
          load_le<std::uint64_t>(bytes, kLength)};
}

std::vector<std::byte> make_vlr(std::string_view user_id, std::uint16_t record_id,
                                std::string_view description, std::span<const std::byte> bytes) {
  assert(bytes.size() <= 0xFFFF);
  std::vector<std::byte> vlr(kVlrHeader + bytes.size());
  put_text(std::span(vlr).subspan(kUserId, 16), user_id);
  store_le(std::span(vlr), kRecordId, record_id);
  store_le(std::span(vlr), kLength, static_cast<std::uint16_t>(bytes.size()));
  put_text(std::span(vlr).subspan(kVlrDescription, 32), description);
  std::ranges::copy(bytes, vlr.begin() + kVlrHeader);
  return vlr;
}

const char* reason_to_drop(std::string_view user_id, std::uint16_t record_id) {
  if (user_id == "copc") return "it describes the places of points in the file that was read";
  if (user_id == "laszip encoded") return "the points are not compressed";
  if (user_id == "LASF_Spec" && record_id == 65535) return "waveform data is not written again";
  return nullptr;
}

void DropNotes::add(std::string_view user_id, std::uint16_t record_id, const char* why,
                    std::vector<std::string>& notes) {
  if (++count_ <= kMostNamed)
    notes.push_back(fmt::format("{} '{}' {} is dropped: {}", kind_, user_id, record_id, why));
}

void DropNotes::finish(std::vector<std::string>& notes) const {
  if (count_ > kMostNamed)
    notes.push_back(fmt::format("{} more {}s are dropped", count_ - kMostNamed, kind_));
}

}  // namespace pss
