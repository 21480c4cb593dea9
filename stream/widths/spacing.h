#pragma once
// How far apart the points of a source are, measured on a sample that depends on nothing but them.

#include <optional>

#include "core/monitor.h"
#include "core/result.h"
#include "core/spacing.h"
#include "stream/limit/memory.h"
#include "stream/passes/source.h"

namespace pss {

/// Measures the spacing of all points but the excluded (Exclusion).
///
/// Reads all positions once to choose the sample, then the blocks around each sampled position,
/// nearest first, for spacing_over().
Result<SpacingSample> sample_spacing(const Source& source, MemoryBudget& budget, Monitor& monitor);

/// The same, where the sample is not of interest.
Result<std::optional<Spacing>> measure_spacing(const Source& source, MemoryBudget& budget,
                                               Monitor& monitor);

}  // namespace pss
