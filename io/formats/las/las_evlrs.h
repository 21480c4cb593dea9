#pragma once
// The records behind the points of a LAS 1.4 file, one at a time.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/file/file.h"
#include "io/formats/las/las_header.h"
#include "io/formats/las/las_vlr.h"

namespace pss {

/// An EVLR where it lies.
struct Evlr {
  VlrHeader header;
  std::uint64_t offset = 0;           ///< of its header
  const char* why_dropped = nullptr;  ///< why no other file carries it on; null where one does

  std::uint64_t size() const { return kEvlrHeader + header.length; }
};

/// Visits all EVLRs in order, up to the first Error.
///
/// Errors: kBadInput where they reach past the end of the file, or are more than any file has.
Result<void> for_each_evlr(const File& file, const LasHeader& header,
                           const std::function<Result<void>(const Evlr&)>& visit);

/// Tells what lies behind the points and is not read.
void note_las_rest(const LasHeader& header, std::uint64_t file_size,
                   std::vector<std::string>& warnings);

}  // namespace pss
