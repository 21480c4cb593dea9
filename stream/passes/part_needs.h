#pragma once
// What a part needs before an operator is applied to it: neighbours that are certain, and memory.

#include <cstdint>

#include "stream/passes/operator.h"
#include "stream/passes/part.h"

namespace pss {

/// What a loaded part turned out to need.
struct Preparation {
  bool wider = false;  ///< some of part.around have a wider reach now: load the candidates again
  std::uint64_t ball_points = 0;  ///< more than part.ball_points: room for so many; otherwise 0
};

/// Prepares a loaded part for an operator, as far as that goes with what is loaded: the grid over
/// its candidates, k-th distances, the number of neighbours that memory is needed for.
Preparation prepare(const Operator& op, const Lattice& lattice, Part& part);

/// What a planned part holds in memory at most while it is worked on, its result included.
std::uint64_t part_bytes(const Operator& op, const PartPlan& plan);

}  // namespace pss
