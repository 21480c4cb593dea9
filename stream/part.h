#pragma once
// A part of a tile with everything within reach of it: planned from block boxes, then loaded.

#include <cstdint>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/neighbours.h"
#include "core/projection.h"
#include "core/result.h"
#include "stream/box_tree.h"
#include "stream/exclusion.h"
#include "stream/memory.h"
#include "stream/store.h"

namespace pss {

/// Consecutive blocks of one tile: the unit that is in memory at once.
struct PartRange {
  std::size_t tile = 0;
  std::size_t first_block = 0;
  std::size_t block_count = 0;
  double reach = 0;  ///< how far around its points others are loaded
};

/// A block of the source that a part needs.
struct BlockRef {
  std::size_t tile = 0;
  BlockInfo block;
};

/// What loading a part will read, known from the block indexes alone.
struct PartPlan {
  PartRange range;
  IndexBox box;                ///< of the part's own points
  std::vector<BlockInfo> own;  ///< in row order
  std::vector<BlockRef> near;  ///< all blocks within reach of the box, own ones among them
  std::uint64_t own_points = 0;
  std::uint64_t near_points = 0;  ///< at most so many candidates
  std::uint64_t ball_points = 0;  ///< at most so many within reach of one point
};

/// A part in memory, on its way through an operator.
struct Part {
  PartRange range;
  IndexBox box;
  std::uint64_t first_row = 0;
  std::vector<std::uint32_t> block_counts;  ///< points of each own block
  std::vector<Index3> own;                  ///< own positions in row order
  std::vector<std::byte> rows;              ///< result rows; each begins with the point's own row
  std::vector<Index3> candidates;  ///< all points within reach that may be neighbours, by key
  std::uint64_t halo = 0;          ///< candidates that are not the part's own
  std::vector<Support> supports;   ///< an operator's widths of each own point, where they differ
  Reservation memory;
};

/// Plans and loads the parts of one source.
///
/// Thread: const members from any number at once.
class PartLoader {
 public:
  /// `row_size` is the size of a result row.
  PartLoader(const Store& source, std::size_t row_size);

  const Store& source() const { return source_; }

  Result<PartPlan> plan(const PartRange& range) const;

  /// Reads a planned part. Candidates come sorted by key, the excluded left out.
  Result<Part> load(const PartPlan& plan) const;

 private:
  Result<void> load_own(const PartPlan& plan, Part& part) const;
  Result<void> load_candidates(const PartPlan& plan, Part& part) const;

  const Store& source_;
  std::size_t row_size_;
  Exclusion exclusion_;
  BoxTree tiles_;
};

}  // namespace pss
