#pragma once
// What a LAS file says before its first point, judged and ready to be read or carried on.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "io/file.h"
#include "io/las_extra.h"
#include "io/las_header.h"
#include "io/las_vlr.h"

namespace pss {

/// Larger header parts and EVLRs are not held in memory: the first are refused, the second dropped.
inline constexpr std::uint64_t kLasLargestCarry = std::uint64_t{64} << 20;

/// The head of a LAS file: all bytes up to the points, and what they mean.
struct LasHead {
  LasHeader header;
  std::vector<std::byte> bytes;
  std::vector<Vlr> vlrs;
  std::vector<ExtraField> extra;
  std::vector<std::string> warnings;  ///< what was odd and read all the same

  Schema schema() const { return las_schema(header.point_format, extra); }
};

/// Understands the bytes up to the points; `file_size` bounds what they may claim.
///
/// Errors: kBadInput, with the path, where they make no sense.
Result<LasHead> parse_las_head(std::vector<std::byte> bytes, const std::string& path,
                               std::uint64_t file_size);

Result<LasHead> read_las_head(const File& file);

/// Reads the EVLRs that can be carried on, one behind the other, as `Carry::tail` has them.
///
/// Errors: kBadInput where they reach past the end of the file.
Result<std::vector<std::byte>> read_las_tail(const File& file, const LasHeader& header,
                                             std::vector<std::string>& warnings);

}  // namespace pss
