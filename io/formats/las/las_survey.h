#pragma once
// What a LAS file says of itself, found in little memory however large its head is.

#include <cstdint>
#include <optional>
#include <string>

#include "io/file/file.h"
#include "io/formats/las/las_file.h"

namespace pss {

/// The head and tail of a LAS file, without the records that only another file would carry on.
struct LasSurvey {
  LasHead head;                 ///< its bytes: the header block and the VLRs that are understood
  std::uint64_t tail_size = 0;  ///< bytes of the EVLRs that can be carried on
  std::optional<std::string> tail_crs;  ///< the coordinate system of a WKT among them

  std::uint64_t carry_size() const { return head.header.point_offset + tail_size; }
};

/// Errors: kBadInput where head or tail make no sense, or EVLRs reach past the end of the file.
/// Cost:   a few hundred KiB of memory; reads the headers of all records.
Result<LasSurvey> survey_las(const File& file);

}  // namespace pss
