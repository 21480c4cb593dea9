#pragma once
// What the file that points are converted to will look like, found out before the first is written.

#include <optional>
#include <span>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "io/convert.h"
#include "io/points/format.h"

namespace pss {

/// What the writer of `output`, a file of `format`, must know of all readers together, which are at
/// their first points before and after. `carry` is the header that it carries on, where there is
/// one.
///
/// Reads all points of those whose count or bounds are not promised, and of all of them before it
/// refuses anything for what a header promises.
/// Errors: kUsage for a scale or offset that is no grid; kBadInput for coordinate systems that
///         differ, for a scale and offset that cannot hold the points, and for a far point that
///         makes a chosen scale too coarse for the others; kInterrupted; those of reading.
Result<WriteOptions> plan_conversion(std::span<Reader* const> readers, std::optional<Carry> carry,
                                     const std::string& output, const Format& format,
                                     const ConvertOptions& options, Monitor& monitor);
/// The first header that a file of the format carries on.
std::optional<Carry> carry_for(std::span<Reader* const> readers, const Format& format);

}  // namespace pss
