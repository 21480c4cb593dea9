#pragma once
// What maps a tile and its halo to new rows.

#include <cstdint>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/passes/part.h"
#include "stream/store/store.h"

namespace pss {

/// What a loaded part turned out to need.
struct Preparation {
  bool wider = false;  ///< some of part.around have a wider reach now: load the candidates again
  std::uint64_t ball_points = 0;  ///< more than part.ball_points: room for so many; otherwise 0
};

/// An operator over one source: a part in, the same part with new positions and rows out.
///
/// Thread: const members from any number at once, one part by one; they spread work with
///         parallel_for.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Lattice, schema and parameters of the result.
  virtual const StoreHeader& result_header() const = 0;

  /// What of the source its parts hold.
  virtual PartNeeds needs() const = 0;

  /// What to load around a part: where its points are not known yet, and for a part whose own
  /// points are loaded.
  virtual std::vector<Surround> around(const PartPlan& plan) const = 0;
  virtual std::vector<Surround> around(const PartPlan& plan, const Part& part) const = 0;

  /// Prepares a loaded part, as far as that goes with what is loaded.
  virtual Preparation prepare(Part& part) const = 0;

  /// What a planned part holds in memory at most while it is worked on, its result included.
  virtual std::uint64_t bytes(const PartPlan& plan) const = 0;

  /// Replaces `part.own` by the new positions on the result's lattice and completes `part.rows`.
  ///
  /// Returns one note a block; a tile's notes are merged in block order by merge_notes().
  /// Leaves early, with anything, when the monitor is stopping.
  virtual std::vector<std::vector<std::byte>> apply(Part& part, Monitor& monitor) const = 0;

  /// The version of what merge_note() makes: see Note.
  virtual std::uint32_t note_version() const = 0;
  /// Adds a block's note to a tile's (empty at first).
  virtual void merge_note(std::vector<std::byte>& tile, std::span<const std::byte> block) const = 0;
};

}  // namespace pss
