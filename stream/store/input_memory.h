#pragma once
// What a job holds of its inputs' names and heads, taken from the limit before any head is read.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/store/manifest.h"

namespace pss {

/// The most that any stage of a job must have at once, beside what its inputs hold: of these
/// inputs' schema, of so many points (0: unknown), and with the largest Reader::unit() of the
/// inputs.
using LeastMemory =
    std::function<std::uint64_t(const StoreHeader& header, std::uint64_t points, std::size_t unit)>;

/// Takes what a job holds of its inputs' names and of the head of the first, for as long as it
/// runs. A head is all that is carried on to a file of the same family of formats: of LAS, header
/// and VLRs.
///
/// Errors: kMemoryLimit where that and what the work takes do not fit, with a limit that does for
///         names, head and work; those of opening the first input.
/// Cost:   opens the first input; reads none of what its head would hold.
Result<Reservation> reserve_inputs(const std::vector<std::string>& inputs, const LeastMemory& least,
                                   MemoryBudget& budget);

/// The same once all inputs are known: they may have wider rows and larger units than the first.
///
/// Errors: kMemoryLimit, with the limit that does.
Result<void> check_least(const StoreHeader& header, std::uint64_t points, std::size_t unit,
                         const LeastMemory& least, const MemoryBudget& budget);

/// Takes what a job holds of a store's header, before it is read.
///
/// Errors: kMemoryLimit, with a limit that leaves usual work its room.
Result<Reservation> reserve_header(const std::string& store, MemoryBudget& budget);
/// The same, and what it holds of the head of the store's first input, for a file that carries it.
Result<Reservation> reserve_header_and_head(const std::string& store, MemoryBudget& budget);

}  // namespace pss
