#pragma once
// Reads the points of a file as a job does, and checks what every reader promises.

#include <memory>

#include "core/result.h"
#include "io/reader.h"

namespace pss::test {

/// To the end, then once more from the middle: the same points, and as many as the header promised.
///
/// A damaged file is refused by kBadInput at any moment, with a sentence that names it.
void read_points(Result<std::unique_ptr<Reader>> opened);

}  // namespace pss::test
