#pragma once
// The public header block of a LAS file: its fields, where they lie, and which values make sense.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/lattice.h"
#include "core/result.h"

namespace pss {

inline constexpr std::size_t kLasSmallestHeader = 227;  ///< of LAS 1.0 to 1.2
inline constexpr std::size_t kLas13Header = 235;
inline constexpr std::size_t kLas14Header = 375;
inline constexpr std::uint16_t kLasWktBit = 0x10;       ///< global encoding: the CRS is WKT
inline constexpr std::uint16_t kLasInternalWave = 0x2;  ///< ... : wave packets in this file
inline constexpr std::size_t kLasReturns = 15;
inline constexpr std::size_t kLasLegacyReturns = 5;

/// The standard's own fields, as they stand in the file; those that a version lacks are zero.
///
/// Source: ASPRS, "LAS Specification 1.4 - R15", 2019, section 2.4. LAS 1.5 - R00 adds the range of
///         GPS times and their offset behind these fields; a file that is carried on keeps them.
struct LasHeader {
  std::uint16_t file_source_id = 0;
  std::uint16_t global_encoding = 0;
  std::uint8_t major = 1;
  std::uint8_t minor = 2;
  std::uint16_t header_size = kLasSmallestHeader;
  std::uint32_t point_offset = kLasSmallestHeader;
  std::uint32_t vlr_count = 0;
  std::uint8_t point_format = 0;  ///< bits 6 and 7 mark compressed points
  std::uint16_t record_length = 0;
  std::uint32_t legacy_count = 0;
  std::array<std::uint32_t, kLasLegacyReturns> legacy_by_return{};
  World3 scale{0, 0, 0};
  World3 offset{0, 0, 0};
  World3 max{0, 0, 0};
  World3 min{0, 0, 0};
  std::uint64_t wave_offset = 0;  ///< from LAS 1.3
  std::uint64_t evlr_offset = 0;  ///< from LAS 1.4
  std::uint32_t evlr_count = 0;
  std::uint64_t count = 0;
  std::array<std::uint64_t, kLasReturns> by_return{};

  bool has_wave_offset() const { return minor >= 3 && header_size >= kLas13Header; }
  bool has_evlrs() const { return minor >= 4; }
  bool compressed() const { return (point_format & 0xC0) != 0; }
  std::uint64_t points() const { return has_evlrs() && count != 0 ? count : legacy_count; }
  /// Requires: no overflow, as check_las_header() makes sure.
  std::uint64_t end_of_points() const { return point_offset + points() * record_length; }
  Lattice grid() const { return {scale, offset}; }
};

/// Whether the bytes begin as a LAS file does.
bool is_las(std::span<const std::byte> bytes);

/// Reads the fields. Requires: at least kLasSmallestHeader bytes; judges nothing.
LasHeader load_las_header(std::span<const std::byte> bytes);

/// Writes the fields over those of an existing header block, other bytes stay.
///
/// Requires: at least header.header_size bytes.
void store_las_header(const LasHeader& header, std::span<std::byte> bytes);

/// Refuses what cannot be read: file, offset, found, expected.
Result<void> check_las_header(const LasHeader& header, const std::string& path,
                              std::uint64_t file_size);

}  // namespace pss
