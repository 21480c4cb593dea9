#pragma once
// Whether a second sheet of points lies over or under a place.

#include <optional>

#include "core/neighbours.h"

namespace pss {

/// Sheets this many widths apart do not disturb each other.
inline constexpr double kWidthsApart = 2.25;

/// How far from the sheet through `position` another one lies, in units of `unit` (the spacing).
///
/// Looks along the normal of the nearest points: a second sheet begins beyond a gap of at least one
/// unit and has a quarter as many points as the first, within a cylinder of two units' radius.
/// Noise and points that fill a volume leave no such gap.
///
/// Requires: the grid holds all points within `farthest` + 2 units.
/// Thread:   any number at once.
std::optional<double> other_sheet(const CellGrid& grid, const Index3& position, double unit,
                                  double farthest);

}  // namespace pss
