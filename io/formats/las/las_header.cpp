#include "io/formats/las/las_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/file/bytes.h"
#include "io/formats/las/las_schema.h"

namespace pss {
namespace {

/// The one drawing of the header: calls `field(offset, value)` for every field we know.
template <class Header, class Field>
void each_field(Header& h, Field&& field) {
  field(4, h.file_source_id);
  field(6, h.global_encoding);
  // 8: GUID, 16 bytes
  field(24, h.major);
  field(25, h.minor);
  // 26: system identifier, 58: generating software, 32 bytes each; 90: day, 92: year of creation
  field(94, h.header_size);
  field(96, h.point_offset);
  field(100, h.vlr_count);
  field(104, h.point_format);
  field(105, h.record_length);
  field(107, h.legacy_count);
  for (std::size_t r = 0; r < kLasLegacyReturns; ++r) field(111 + 4 * r, h.legacy_by_return[r]);
  for (std::size_t a = 0; a < 3; ++a) {
    field(131 + 8 * a, h.scale[a]);
    field(155 + 8 * a, h.offset[a]);
    field(179 + 16 * a, h.max[a]);
    field(187 + 16 * a, h.min[a]);
  }
  field(227, h.wave_offset);
  field(235, h.evlr_offset);
  field(243, h.evlr_count);
  field(247, h.count);
  for (std::size_t r = 0; r < kLasReturns; ++r) field(255 + 8 * r, h.by_return[r]);
  // 375: from LAS 1.5, largest and least GPS time and time offset, 18 bytes
}

/// How much of the header block has the meaning of the drawing above.
std::size_t known_size(std::uint8_t minor, std::size_t header_size) {
  const std::size_t standard = minor >= 4   ? kLas14Header
                               : minor == 3 ? kLas13Header
                                            : kLasSmallestHeader;
  return std::min(standard, header_size);
}

Error bad(const std::string& path, std::size_t offset, const std::string& what) {
  return {Fault::kBadInput, fmt::format("{}: LAS header, offset {}: {}", path, offset, what)};
}

Result<void> check_version(const LasHeader& h, const std::string& path) {
  if (h.major != 1 || h.minor > 5)
    return bad(path, 24, fmt::format("found version {}.{}, expected 1.0 to 1.5", h.major, h.minor));
  const std::size_t least = h.minor >= 4 ? kLas14Header : kLasSmallestHeader;
  if (h.header_size < least)
    return bad(path, 94,
               fmt::format("found header size {}, expected at least {} for LAS 1.{}", h.header_size,
                           least, h.minor));
  return {};
}

Result<void> check_layout(const LasHeader& h, const std::string& path, std::uint64_t file_size) {
  if (h.point_offset < h.header_size)
    return bad(path, 96,
               fmt::format("found points at offset {}, expected them after the header "
                           "of {} bytes",
                           h.point_offset, h.header_size));
  if (h.point_offset > file_size)
    return bad(path, 96,
               fmt::format("found points at offset {}, expected them within the file "
                           "of {} bytes; it is cut short or damaged",
                           h.point_offset, file_size));
  return {};
}

Result<void> check_format(const LasHeader& h, const std::string& path) {
  if (h.compressed())
    return Error{Fault::kBadInput,
                 fmt::format("{}: LAZ is not supported yet; decompress it to LAS first (laszip, "
                             "las2las or pdal translate)",
                             path)};
  if (h.point_format > kLasLastFormat)
    return bad(
        path, 104,
        fmt::format("found point format {}, expected 0 to {}", h.point_format, kLasLastFormat));
  const std::size_t least = las_record_size(h.point_format);
  if (h.record_length < least)
    return bad(path, 105,
               fmt::format("found point records of {} bytes, expected at least {} for "
                           "point format {}",
                           h.record_length, least, h.point_format));
  return {};
}

Result<void> check_count(const LasHeader& h, const std::string& path, std::uint64_t file_size) {
  const std::uint64_t there = (file_size - h.point_offset) / h.record_length;
  if (h.points() <= there) return {};
  return bad(path, h.has_evlrs() && h.count != 0 ? 247 : 107,
             fmt::format("found {} points of {} bytes from offset {} to the file's end, expected "
                         "the {} that the header promises; the file is cut short or damaged",
                         there, h.record_length, h.point_offset, h.points()));
}

/// Positions must be finite numbers, whatever the 32-bit integers.
Result<void> check_grid(const LasHeader& h, const std::string& path) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isnormal(h.scale[a]) || h.scale[a] < 0)
      return bad(
          path, 131 + 8 * a,
          fmt::format("found scale {} for {}, expected a positive number", h.scale[a], "xyz"[a]));
    if (!std::isfinite(std::abs(h.offset[a]) + h.scale[a] * 2147483648.0))
      return bad(path, 155 + 8 * a,
                 fmt::format("found offset {} with scale {} for {}, expected finite positions",
                             h.offset[a], h.scale[a], "xyz"[a]));
  }
  return {};
}

}  // namespace

bool is_las(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "LASF", 4) == 0;
}

LasHeader load_las_header(std::span<const std::byte> bytes) {
  LasHeader header;
  const auto load = [&](std::size_t end) {
    each_field(header, [&]<class T>(std::size_t offset, T& value) {
      if (offset + sizeof(T) <= end) value = load_le<T>(bytes, offset);
    });
  };
  load(kLasSmallestHeader);
  // Only now is it known how far the header goes, and what lies behind its first 227 bytes.
  load(std::min(known_size(header.minor, header.header_size), bytes.size()));
  return header;
}

void store_las_header(const LasHeader& header, std::span<std::byte> bytes) {
  const std::size_t end = known_size(header.minor, header.header_size);
  each_field(header, [&]<class T>(std::size_t offset, const T& value) {
    if (offset + sizeof(T) <= end) store_le(bytes, offset, value);
  });
}

Result<void> check_las_header(const LasHeader& header, const std::string& path,
                              std::uint64_t file_size) {
  PSS_TRY(check_version(header, path));
  PSS_TRY(check_format(header, path));
  PSS_TRY(check_layout(header, path, file_size));
  PSS_TRY(check_grid(header, path));
  return check_count(header, path, file_size);
}

}  // namespace pss
