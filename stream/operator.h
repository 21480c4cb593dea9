#pragma once
// What maps a tile and its halo to new rows.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/part.h"
#include "stream/store.h"

namespace pss {

/// An operator over one source: a part in, the same part with new positions and rows out.
///
/// Thread: const members from one thread at a time; they spread work with parallel_for.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Lattice, schema and parameters of the result.
  virtual const StoreHeader& result_header() const = 0;

  /// What of the source its parts hold.
  virtual PartNeeds needs() const = 0;

  /// How far around a part to load at first.
  virtual double first_reach() const = 0;

  /// Prepares a loaded part; a value is the range with the reach, or with the points in a ball,
  /// that it really needs, to be loaded again with.
  virtual std::optional<PartRange> prepare(Part& part) const = 0;

  /// What a planned part holds in memory at most while it is worked on, its result included.
  virtual std::uint64_t bytes(const PartPlan& plan) const = 0;

  /// Replaces `part.own` by the new positions on the result's lattice and completes `part.rows`.
  ///
  /// Returns one note a block; a tile's notes are merged in block order by merge_notes().
  /// Leaves early, with anything, when the monitor is stopping.
  virtual std::vector<std::vector<std::byte>> apply(Part& part, Monitor& monitor) const = 0;

  /// Adds a block's note to a tile's (empty at first).
  virtual void merge_note(std::vector<std::byte>& tile, std::span<const std::byte> block) const = 0;
};

}  // namespace pss
