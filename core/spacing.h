#pragma once
// The rule that turns a distance to neighbours into the mean spacing of points on a surface.

namespace pss {

/// The nearest-neighbour rank that spacings are measured at, among distinct positions.
inline constexpr int kSpacingRank = 16;

/// d16 to spacing: a disc of radius d16 holds 16 points, each with an area of spacing^2.
double spacing_of_d16(double d16);

}  // namespace pss
