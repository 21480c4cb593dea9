#include "stream/passes/index_cache.h"

#include <algorithm>

namespace pss {

Result<const std::vector<BlockInfo>*> IndexCache::blocks_of(std::size_t tile) {
  const auto found =
      std::ranges::find_if(indexes_, [&](const auto& index) { return index.first == tile; });
  if (found != indexes_.end()) {
    indexes_.splice(indexes_.begin(), indexes_, found);
  } else {
    PSS_ASSIGN(std::vector<BlockInfo> blocks, source_.read_index(tile));
    indexes_.emplace_front(tile, std::move(blocks));
    if (indexes_.size() > kMost) indexes_.pop_back();
  }
  return &indexes_.front().second;
}

}  // namespace pss
