#pragma once
// Blocks compressed by all threads at once, handed on in order.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "core/lattice.h"
#include "core/monitor.h"
#include "core/result.h"
#include "io/points/schema.h"
#include "stream/store/block.h"

namespace pss {

/// Fills one block: `positions` and `rows` hold the points [begin, begin + n) of the sequence.
using BlockSource =
    std::function<void(std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows)>;

/// Compresses points [0, count) in blocks of `block_points`, several at once, and hands the blocks
/// over in order.
///
/// Thread: `source` is called by several threads at once, `sink` by any, for one block at a time.
/// Errors: what `sink` returns; kInterrupted.
Result<void> encode_blocks(const Schema& schema, std::size_t count, std::size_t block_points,
                           const BlockSource& source,
                           const std::function<Result<void>(const EncodedBlock&)>& sink,
                           const Monitor& monitor);

/// What encode_blocks holds at most.
std::uint64_t encode_blocks_memory(const Schema& schema, std::size_t block_points);

}  // namespace pss
