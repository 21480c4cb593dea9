#pragma once
// What maps a tile and its halo to new rows.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "stream/passes/neighbourhood.h"
#include "stream/passes/part.h"
#include "stream/store/store.h"

namespace pss {

/// What an operator makes of a part: any number of rows, in an order that follows from the part's.
struct Rows {
  /// On the result's lattice. Empty where the operator writes columns alone, which go with the rows
  /// of its source: one for each own point.
  std::vector<Index3> positions;
  std::vector<std::byte> bytes;  ///< rows of the result's schema
  /// What the operator noted of each own block; a tile's notes are merged in their order.
  std::vector<std::vector<std::byte>> notes;
};

/// Maps parts to rows. What it gives for an own point depends on the points within its
/// neighbourhood alone, not on how tiles are cut into parts.
///
/// Thread: const members from any number at once, one part by one; they spread work with
///         parallel_for.
class Operator {
 public:
  /// One task works on at most so many own points at a time.
  static constexpr std::size_t kTaskPoints = 1024;

  virtual ~Operator() = default;

  /// Lattice, schema and parameters of the result.
  virtual const StoreHeader& result_header() const = 0;
  /// Whether its rows are columns alone, to be joined to those of its source.
  virtual bool columns_alone() const { return false; }

  /// What of the source its parts hold.
  virtual const PartNeeds& needs() const = 0;
  /// How far its points look.
  virtual const Neighbourhood& neighbourhood() const = 0;

  /// What a task holds while it works, where no point looks at more than `ball_points` neighbours.
  virtual std::uint64_t scratch_bytes(std::uint64_t ball_points) const = 0;
  /// Whether that grows with the number of neighbours, so that these are to be counted.
  virtual bool gathers_neighbours() const { return true; }
  /// At most so many rows come of so many own points.
  virtual std::uint64_t most_rows(std::uint64_t own_points) const { return own_points; }

  /// The rows of a part. May take `part.own` and `part.rows` over, whose memory they then are.
  ///
  /// Leaves early, with anything, when the monitor is stopping.
  virtual Rows apply(Part& part, Monitor& monitor) const = 0;

  /// The version of what merge_note() makes: see Note.
  virtual std::uint32_t note_version() const = 0;
  /// Adds a block's note to a tile's, or a tile's to that of the store (empty at first).
  virtual void merge_note(std::vector<std::byte>& total, std::span<const std::byte> next) const = 0;
};

}  // namespace pss
