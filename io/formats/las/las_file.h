#pragma once
// What a LAS file says before its first point, judged and ready to be read or carried on.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/file/file.h"
#include "io/formats/las/las_extra.h"
#include "io/formats/las/las_header.h"
#include "io/formats/las/las_vlr.h"
#include "io/points/points.h"

namespace pss {

/// Larger header parts and EVLRs are not held in memory: the first are refused, the second dropped.
inline constexpr std::uint64_t kLasLargestCarry = std::uint64_t{64} << 20;

/// The head of a LAS file: all bytes up to the points, and what they mean.
struct LasHead {
  LasHeader header;
  std::vector<std::byte> bytes;
  std::vector<ExtraField> extra;
  std::vector<std::string> warnings;  ///< what was odd and read all the same

  VlrRange vlrs() const { return list_vlrs(bytes, header.header_size, header.vlr_count); }
  Schema schema() const { return las_schema(header.point_format, extra); }
};

/// The header block, where it makes sense; `file_size` bounds what it may claim.
///
/// Errors: kBadInput, with the path.
Result<LasHeader> understood_las_header(std::span<const std::byte> bytes, const std::string& path,
                                        std::uint64_t file_size);

/// Understands a head of which `bytes` has at least the header block and the extra-bytes VLRs, and
/// the file itself had `vlrs` that lie whole before its points.
LasHead las_head(const LasHeader& header, std::vector<std::byte> bytes, std::size_t vlrs);

/// Understands all bytes up to the points.
///
/// Errors: kBadInput, with the path, where they make no sense.
Result<LasHead> parse_las_head(std::vector<std::byte> bytes, const std::string& path,
                               std::uint64_t file_size);

/// Reads what another file carries on: the bytes up to the points, and of the EVLRs `tail_size`
/// bytes, as survey_las() counted them.
///
/// Cost: holds what it returns and no more.
Result<Carry> read_las_carry(const File& file, const LasHeader& header, std::uint64_t tail_size);

}  // namespace pss
