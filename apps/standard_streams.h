#pragma once
// stdin, stdout and stderr: data go to stdout and must arrive, words go to stderr and may be lost.

#include <string_view>

#include "core/result.h"

namespace pss {

/// Opens /dev/null as those of the descriptors 0, 1 and 2 with which the program was not started:
/// the next file that it opens would get the number, and what is printed would go into that file.
///
/// What is written to such a stderr is lost; such a stdout takes nothing, so print_data() fails.
///
/// Requires: no file has been opened, and there is one thread.
/// Errors:   kFailed where there is no /dev/null.
Result<void> open_missing_streams();

/// Writes data to stdout, all the way to the system.
///
/// Errors: kFailed where it is closed, full, or a pipe without a reader.
Result<void> print_data(std::string_view data);

/// Writes words to stderr; a failure is ignored, as there is nobody to tell it.
void print_words(std::string_view words);

}  // namespace pss
