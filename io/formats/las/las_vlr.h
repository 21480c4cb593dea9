#pragma once
// Variable length records of LAS, before the points (VLR) and after them (EVLR).

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
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

/// Records one behind the other, each understood when it is come to: a list of them would be larger
/// than the bytes of a million empty ones.
///
/// Requires: the bytes outlive it.
class VlrRange {
 public:
  /// At most `most` records of `bytes` from `first` on, up to the first that does not lie whole.
  VlrRange(std::span<const std::byte> bytes, std::size_t first, std::size_t header_size,
           std::size_t most)
      : bytes_(bytes), first_(first), header_size_(header_size), most_(most) {}

  class Iterator {
   public:
    using value_type = Vlr;
    using difference_type = std::ptrdiff_t;

    Iterator(const VlrRange& range, std::size_t position);
    const Vlr& operator*() const { return *vlr_; }
    Iterator& operator++();
    void operator++(int) { ++*this; }
    bool operator==(std::default_sentinel_t /*end*/) const { return !vlr_; }

   private:
    void look(std::size_t position);
    const VlrRange* range_;
    std::size_t number_ = 0;
    std::optional<Vlr> vlr_;
  };
  Iterator begin() const { return {*this, first_}; }
  static std::default_sentinel_t end() { return {}; }

  std::size_t size() const;  ///< Cost: linear
  bool empty() const { return begin() == end(); }

 private:
  std::span<const std::byte> bytes_;
  std::size_t first_, header_size_, most_;
};

/// The VLRs that lie whole in `head`, from `header_size` on, at most `count`.
VlrRange list_vlrs(std::span<const std::byte> head, std::size_t header_size, std::uint32_t count);

/// All EVLRs that lie whole in `tail`, one behind the other.
VlrRange list_evlrs(std::span<const std::byte> tail);

/// What a record's own header says of it.
struct VlrHeader {
  std::string user_id;
  std::uint16_t record_id = 0;
  std::uint64_t length = 0;

  bool is(std::string_view user, std::uint16_t record) const {
    return user_id == user && record_id == record;
  }
};
/// Requires: kVlrHeader bytes.
VlrHeader load_vlr_header(std::span<const std::byte> bytes);
/// Requires: kEvlrHeader bytes.
VlrHeader load_evlr_header(std::span<const std::byte> bytes);

/// A VLR whole. Requires: at most 65535 bytes of payload.
std::vector<std::byte> make_vlr(std::string_view user_id, std::uint16_t record_id,
                                std::string_view description, std::span<const std::byte> bytes);

/// Why a record is not written again ("compressed points are not"), or null where it is.
const char* reason_to_drop(std::string_view user_id, std::uint16_t record_id);

/// Notes of records that are dropped: a few by name, the others counted, as a file may have a
/// million.
class DropNotes {
 public:
  explicit DropNotes(std::string_view kind) : kind_(kind) {}
  void add(std::string_view user_id, std::uint16_t record_id, const char* why,
           std::vector<std::string>& notes);
  /// After the last.
  void finish(std::vector<std::string>& notes) const;
  bool any() const { return count_ > 0; }

 private:
  std::string kind_;
  std::size_t count_ = 0;
};

}  // namespace pss
