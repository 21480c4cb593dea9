#include "stream/encode_blocks.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace pss {
namespace {

std::size_t blocks_at_once() { return static_cast<std::size_t>(thread_count()) + 1; }

EncodedBlock encode_part(const Schema& schema, std::size_t begin, std::size_t count,
                         const BlockSource& source) {
  std::vector<Index3> positions(count);
  std::vector<std::byte> rows(count * schema.row_size());
  source(begin, positions, rows);
  return encode_block(schema, positions, rows);
}

}  // namespace

Result<void> encode_blocks(const Schema& schema, std::size_t count, std::size_t block_points,
                           const BlockSource& source,
                           const std::function<Result<void>(const EncodedBlock&)>& sink,
                           const Monitor& monitor) {
  std::vector<EncodedBlock> blocks(blocks_at_once());
  for (std::size_t done = 0; done < count;) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "stopped while writing points"};
    const std::size_t left = (count - done + block_points - 1) / block_points;
    const std::size_t now = std::min(left, blocks.size());
    parallel_for(now, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        const std::size_t first = done + b * block_points;
        blocks[b] = encode_part(schema, first, std::min(block_points, count - first), source);
      }
    });
    for (std::size_t b = 0; b < now; ++b) PSS_TRY(sink(blocks[b]));
    done += std::min(count - done, now * block_points);
  }
  return {};
}

std::uint64_t encode_blocks_memory(const Schema& schema, std::size_t block_points) {
  const std::size_t row = sizeof(Index3) + schema.row_size();
  return blocks_at_once() * (encode_bytes(schema, block_points) + block_points * row);
}

}  // namespace pss
