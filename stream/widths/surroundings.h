#pragma once
// What lies around a few sites of a source, some at a time: for samples, not for all points.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/source.h"

namespace pss {

/// A position, and how far around it is looked.
struct Site {
  Index3 position{};
  double reach = 0;
};

/// Consecutive sites with all that may be a neighbour within their reach.
struct Surroundings {
  std::size_t first = 0;
  std::size_t count = 0;
  std::vector<Index3> points;  ///< by key; more than within reach may be among them
};

/// So many points are in memory at once; a site with more within its reach is left out.
inline constexpr std::size_t kMostAround = 16384;

/// Calls `use` for consecutive sites until all had their turn, but for those left out.
///
/// Points that are no neighbours of others (Exclusion) are not among the surroundings. Which sites
/// come together depends on the memory there is; what lies within reach of each does not.
///
/// Requires: sites in key order, so that neighbours share blocks.
/// Errors:   kMemoryLimit, kInterrupted, and what reading the stores gives.
Result<void> for_each_surroundings(const Source& source, std::span<const Site> sites,
                                   MemoryBudget& budget, Monitor& monitor,
                                   const std::function<void(const Surroundings&)>& use);

/// What that reserves.
std::uint64_t surroundings_memory();

}  // namespace pss
