#pragma once
// Parts of a source in order, loaded and prepared as the memory limit lets them.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/operator.h"
#include "stream/passes/part.h"

namespace pss {

/// What remains to be done, in order: whole tiles, or parts of one that was cut.
class PartQueue {
 public:
  /// The tiles of a pass from number `first_tile` on.
  PartQueue(const PassSources& sources, std::size_t first_tile);

  std::optional<PartRange> pop();
  void push_halves(const PartRange& range);

 private:
  std::optional<std::size_t> next_tile() const;
  std::span<const TileInfo> tiles_;
  const std::vector<std::size_t>* only_;  ///< null: all
  std::size_t next_;                      ///< a tile's number, or its place in only_
  std::vector<PartRange> cut_;            ///< the last is the next
};

/// What parts may take of the memory limit: what is free before the first is loaded.
struct Room {
  explicit Room(const MemoryBudget& budget) : limit(budget.limit()), bytes(budget.available()) {}

  std::uint64_t limit;
  std::uint64_t bytes;
};

/// Whether a planned part may be loaded in one; otherwise it is to be cut.
///
/// Errors: kMemoryLimit where a block with what lies around it exceeds the limit: place, density,
///         a limit that does for the whole store, and what radius might, where any can.
Result<bool> fits(const PartLoader& loader, const Operator& op, const PartPlan& plan,
                  const Room& room);
/// Beyond so many candidates no part fits: what plan_near() may stop to keep at.
std::uint64_t most_candidates(const Room& room);

/// Takes memory for a part: grows its reservation to `bytes`, waiting where others will give some
/// back. False where nobody will.
using TakeMemory = std::function<bool(Reservation& memory, std::uint64_t bytes)>;

/// Thread: one.
class PartSource {
 public:
  PartSource(const PassSources& sources, const Operator& op, const MemoryBudget& budget,
             std::size_t first_tile, TakeMemory take_memory);

  /// The next part that fits, cutting tiles that do not; empty at the end.
  ///
  /// Errors: kMemoryLimit where a block with what lies around it does not fit.
  Result<std::optional<Part>> next();

  std::uint64_t reloaded_parts() const { return reloaded_; }  ///< for a wider reach

 private:
  /// Loads and prepares a part; empty where it was cut instead.
  Result<std::optional<Part>> load(const PartRange& range);
  Result<std::optional<Part>> load_around(PartPlan& plan, Part part);
  /// Takes what the plan needs; false where the part was cut instead.
  Result<bool> take_memory(const PartPlan& plan, Reservation& memory);

  const Operator& op_;
  Room room_;
  PartLoader loader_;
  PartQueue queue_;
  TakeMemory take_memory_;
  std::uint64_t reloaded_ = 0;
};

}  // namespace pss
