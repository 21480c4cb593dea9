#pragma once
// What a LAS head says beyond what all formats have.

#include <vector>

#include "io/points/format.h"

namespace pss {

/// Version, point format, bytes of a record, and all VLRs and EVLRs of a carried LAS head. None for
/// a head that was not held.
std::vector<Fact> las_facts(const Carry& carry);

}  // namespace pss
