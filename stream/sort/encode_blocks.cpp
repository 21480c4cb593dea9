#include "stream/sort/encode_blocks.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/spares.h"

namespace pss {
namespace {

/// Points on their way into a block.
struct Workspace {
  std::vector<Index3> positions;
  std::vector<std::byte> rows;
};

EncodedBlock encode_part(const Schema& schema, std::size_t begin, std::size_t count,
                         const BlockSource& source, Workspace& space) {
  space.positions.resize(count);
  space.rows.resize(count * schema.row_size());
  source(begin, space.positions, space.rows);
  return encode_block(schema, space.positions, space.rows);
}

}  // namespace

Result<void> encode_blocks(const Schema& schema, std::size_t count, std::size_t block_points,
                           const BlockSource& source,
                           const std::function<Result<void>(const EncodedBlock&)>& sink,
                           const Monitor& monitor) {
  std::vector<EncodedBlock> blocks(slots_in_order());
  Spares<Workspace> spares;
  bool stopped = false;
  Result<void> result;
  parallel_in_order(
      blocks.size(),
      [&](std::size_t k) {
        if (k * block_points >= count) return false;
        stopped = monitor.stopping();
        return !stopped;
      },
      [&](std::size_t k) {
        std::unique_ptr<Workspace> space = spares.take();
        if (!space) space = std::make_unique<Workspace>();
        const std::size_t begin = k * block_points;
        blocks[k % blocks.size()] =
            encode_part(schema, begin, std::min(block_points, count - begin), source, *space);
        spares.give(std::move(space));
      },
      [&](std::size_t k) {
        result = sink(blocks[k % blocks.size()]);
        return result.has_value();
      });
  if (result && stopped) return Error{Fault::kInterrupted, "stopped while writing points"};
  return result;
}

std::uint64_t encode_blocks_memory(const Schema& schema, std::size_t block_points) {
  // What a thread's work on a block takes, and the blocks that are done and not handed on.
  const std::uint64_t row = sizeof(Index3) + schema.row_size();
  const std::uint64_t done = block_points * row + 64 * (schema.fields().size() + 2);
  return static_cast<std::uint64_t>(thread_count()) *
             (encode_bytes(schema, block_points) + block_points * row) +
         slots_in_order() * done;
}

}  // namespace pss
