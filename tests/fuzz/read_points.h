#pragma once
// Reads the points of a file as a job does, and checks what every reader promises.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/reader.h"

namespace pss::test {

/// Of a file with these bytes, to the end, then once more from the middle: the same points, and as
/// many as the header promised. No more is allocated than 4 MiB and 64 times the size.
///
/// A damaged file is refused by kBadInput at any moment, with a sentence that names it.
void read_points(const std::uint8_t* data, std::size_t size,
                 Result<std::unique_ptr<Reader>> (*open)(const std::string& path));

}  // namespace pss::test
