#pragma once
// Variable length records of LAS, before the points (VLR) and after them (EVLR).

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pss {

inline constexpr std::size_t kVlrHeader = 54;
inline constexpr std::size_t kEvlrHeader = 60;

/// A record within a span of bytes.
struct Vlr {
  std::string user_id;
  std::uint16_t record_id = 0;
  std::size_t position = 0;     ///< of its header
  std::size_t header_size = 0;  ///< kVlrHeader or kEvlrHeader
  std::size_t length = 0;       ///< bytes after its header

  std::size_t end() const { return position + header_size + length; }
  bool is(std::string_view user, std::uint16_t record) const {
    return user_id == user && record_id == record;
  }
};

/// The bytes after a record's header.
std::span<const std::byte> payload(const Vlr& vlr, std::span<const std::byte> bytes);

/// The VLRs that lie whole in `head`, from `header_size` on, at most `count`.
std::vector<Vlr> list_vlrs(std::span<const std::byte> head, std::size_t header_size,
                           std::uint32_t count);

/// All EVLRs that lie whole in `tail`, one behind the other.
std::vector<Vlr> list_evlrs(std::span<const std::byte> tail);

/// What an EVLR's header says of it.
struct EvlrHeader {
  std::string user_id;
  std::uint16_t record_id = 0;
  std::uint64_t length = 0;
};
/// Requires: kEvlrHeader bytes.
EvlrHeader load_evlr_header(std::span<const std::byte> bytes);

/// A VLR whole. Requires: at most 65535 bytes of payload.
std::vector<std::byte> make_vlr(std::string_view user_id, std::uint16_t record_id,
                                std::string_view description, std::span<const std::byte> bytes);

/// Why a record is not written again ("compressed points are not"), or null where it is.
const char* reason_to_drop(std::string_view user_id, std::uint16_t record_id);

}  // namespace pss
