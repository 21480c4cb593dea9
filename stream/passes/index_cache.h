#pragma once
// The block indexes of a source's tiles that were used last, for searches at many places.

#include <cstddef>
#include <list>
#include <utility>
#include <vector>

#include "core/result.h"
#include "stream/passes/source.h"

namespace pss {

/// Thread: one.
class IndexCache {
 public:
  explicit IndexCache(const Source& source) : source_(source) {}
  explicit IndexCache(Source&&) = delete;  // it must outlive the cache

  /// The blocks of a tile, valid until the next call. Errors: what reading the store gives.
  Result<const std::vector<BlockInfo>*> blocks_of(std::size_t tile);

 private:
  static constexpr std::size_t kMost = 32;
  const Source& source_;
  std::list<std::pair<std::size_t, std::vector<BlockInfo>>> indexes_;  ///< last used first
};

}  // namespace pss
