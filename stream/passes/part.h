#pragma once
// A part of a tile with everything within reach of it: planned from block boxes, then loaded.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/neighbours.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/box_tree.h"
#include "stream/passes/normals.h"
#include "stream/passes/outputs.h"
#include "stream/passes/source.h"

namespace pss {

/// What a pass reads: the points that are asked about, and those around them, which may be others.
///
/// Both have one lattice; the sources outlive it.
struct PassSources {
  PassSources(const Source& source)  // NOLINT(google-explicit-constructor): mostly one is both
      : PassSources(source, source) {}
  PassSources(const Source& asked, const Source& around) : queries(asked), neighbours(around) {}

  bool same() const { return &queries == &neighbours; }

  const Source& queries;
  const Source& neighbours;
  /// The numbers of the queries' tiles that the pass is over, ascending; all where there is none.
  std::optional<std::vector<std::size_t>> tiles;
};

/// What an operator wants of its sources in a part.
struct PartNeeds {
  std::size_t row_size = 0;              ///< of a row of the part
  std::vector<KeptBytes> kept;           ///< what it takes over of the source's row
  std::optional<NormalColumns> normals;  ///< of the candidates
};

/// Consecutive blocks of one tile: the unit that is in memory at once.
struct PartRange {
  std::size_t tile = 0;
  std::size_t first_block = 0;
  std::size_t block_count = 0;
};

/// Some of a part's own points, and how far around them others are loaded.
struct Surround {
  IndexBox box;
  double reach = 0;
  PointRange own{0, 0};  ///< which points, where an operator wants to know
  bool certain = false;  ///< for an operator: all that they need has been found
};

/// A block of the neighbours' source that a part needs.
struct BlockRef {
  std::size_t tile = 0;
  BlockInfo block;
  std::vector<std::uint32_t> around;  ///< the numbers of the surrounds that reach into it
};

/// What loading a part will read, known from the block indexes alone.
struct PartPlan {
  PartRange range;
  Lattice lattice;             ///< of the positions
  bool ordered = true;         ///< candidates come in key order
  IndexBox box;                ///< of the part's own points
  std::vector<BlockInfo> own;  ///< in row order
  std::uint64_t own_points = 0;
  std::vector<Surround> around;     ///< what else to load; nothing where empty
  std::vector<BlockRef> near;       ///< all blocks within reach, own ones among them
  std::uint64_t near_points = 0;    ///< at most so many candidates
  std::uint64_t ball_points = 0;    ///< at most so many within reach of one point, by blocks
  std::uint64_t measured_ball = 0;  ///< the same, counted; 0: not yet
};

/// A part in memory, on its way through an operator.
struct Part {
  PartRange range;
  std::uint64_t first_row = 0;
  std::vector<std::uint32_t> block_counts;  ///< points of each own block
  std::vector<Index3> own;                  ///< own positions in row order
  std::vector<std::byte> rows;              ///< with what is kept of each point's own row
  std::vector<std::uint8_t> excluded;  ///< 1 for own points that are no neighbours; empty: none is
  std::vector<Surround> around;
  std::vector<Index3> candidates;  ///< all points within reach that may be neighbours, by key
  std::vector<Normal> normals;     ///< of the candidates, where the operator wants them
  std::uint64_t halo = 0;          ///< candidates that are not the part's own
  std::uint64_t ball_points = 0;   ///< at most so many within reach of one point: what is reserved
  std::optional<CellGrid> grid;    ///< over the candidates, where points look around
  /// From each own point to its k-th nearest position, where the operator wants to know; below 0
  /// where there are fewer within the cap.
  std::vector<double> kth_distances;
  Reservation memory;

  void drop_candidates();
};

/// Plans and loads the parts of a pass.
///
/// Thread: const members from any number at once.
class PartLoader {
 public:
  PartLoader(const PassSources& sources, const PartNeeds& needs);

  const Source& queries() const { return sources_.queries; }
  const Source& neighbours() const { return sources_.neighbours; }

  /// The own blocks alone.
  Result<PartPlan> plan(const PartRange& range) const;
  /// Adds what lies around: the blocks within reach of plan.around.
  ///
  /// Beyond `most_points` blocks are counted, not kept.
  Result<void> plan_near(PartPlan& plan, std::uint64_t most_points) const;

  /// Reads the own points of a plan and their rows.
  Result<Part> load_own(const PartPlan& plan) const;
  /// Replaces the candidates by those of a plan: sorted by key, those of one place in row order,
  /// the excluded left out.
  Result<void> load_near(const PartPlan& plan, Part& part) const;

 private:
  /// A block on its way into the candidates.
  struct NearBlock {
    std::vector<Index3> positions;
    std::vector<Normal> normals;
    std::vector<std::uint8_t> excluded;
  };
  std::vector<std::vector<std::uint32_t>> surrounds_by_tile(const std::vector<Surround>& around,
                                                            std::vector<std::size_t>& tiles) const;
  Result<void> read_own(const BlockInfo& block, Part& part) const;
  bool is_own(const BlockRef& near, const Part& part) const;
  static void copy_own(const Part& part, const BlockInfo& block, NearBlock& near);
  /// Writes what is wanted of a near block to the candidates from range.begin on; moves range.end.
  Result<void> load_block(const PartPlan& plan, std::size_t number, PointRange& range,
                          Part& part) const;
  Result<void> read_near(const BlockRef& near, const Part& part, NearBlock& block) const;

  PassSources sources_;
  PartNeeds needs_;
  BoxTree tiles_;  ///< of the neighbours
};

}  // namespace pss
