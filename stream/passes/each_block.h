#pragma once
// Work on many blocks by all threads.

#include <cstddef>
#include <functional>

#include "core/result.h"

namespace pss {

/// Calls work(b) for the numbers b from 0 to count by all threads; returns the first error in the
/// order of the numbers.
Result<void> for_each_block(std::size_t count,
                            const std::function<Result<void>(std::size_t)>& work);

}  // namespace pss
