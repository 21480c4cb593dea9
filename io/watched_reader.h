#pragma once
// A reader of a file that must stay as it is until its last record was read.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "io/file/fingerprint.h"
#include "io/points/reader.h"

namespace pss {

/// Opens a file whose record was taken before anything of it was read: see settled_fingerprint().
///
/// The file is compared with its record once its header is read, at its end, and where reading it
/// fails; and the points read are counted. `count` is how many there must be, by default as many
/// as the header promises, if it does.
///
/// Errors: those of open_reader_holding() and of its readers; kFailed where the file changed
/// meanwhile.
Result<std::unique_ptr<Reader>> open_watched(const InputRecord& expected, HeadBytes bytes,
                                             std::optional<std::uint64_t> count = {});

/// A function like open_watched(), for those whose inputs may be no files.
using OpenInput = std::function<Result<std::unique_ptr<Reader>>(
    const InputRecord& expected, HeadBytes bytes, std::optional<std::uint64_t> count)>;

}  // namespace pss
