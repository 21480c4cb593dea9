#pragma once
// Changes inputs in the ways that files are damaged, or made to do harm.

#include <random>

#include "tests/fuzz/target.h"

namespace pss::test {

/// One of the inputs, changed a little; what is done is the random numbers' choice alone.
Bytes mutated(std::span<const Bytes> inputs, std::mt19937_64& random);

}  // namespace pss::test
