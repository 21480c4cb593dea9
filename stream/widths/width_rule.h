#pragma once
// The rule that turns measured noise and shape into a width.

#include <array>

#include "stream/widths/noise.h"

namespace pss {

/// What kept the width from being larger.
enum class WidthLimit {
  kNone,       ///< the largest that is ever chosen
  kNoise,      ///< less noise is not worth more neighbours
  kShape,      ///< wider fits would bend the surface more than they calm it
  kSheets,     ///< a second sheet is near
  kCurvature,  ///< the surface turns too much within a wider fit
  kExtent,     ///< wider fits reach boundaries, or are not determined
  kNoSurface,  ///< no width saw a surface: too few points, or they fill a volume
};

inline constexpr std::array kWidthLimits{
    WidthLimit::kNone,      WidthLimit::kNoise,  WidthLimit::kShape,    WidthLimit::kSheets,
    WidthLimit::kCurvature, WidthLimit::kExtent, WidthLimit::kNoSurface};

struct WidthChoice {
  double multiple = 2;  ///< h over spacing
  WidthLimit limit = WidthLimit::kNoSurface;
  double error = 0;  ///< that is left of the noise, expected, in spacings
};

/// The narrowest and widest h, in spacings, that are chosen.
inline constexpr double kNarrowest = kTriedWidths.front();
inline constexpr double kWidest = kTriedWidths.back();

/// The h between kNarrowest and kWidest where the error is least: noise falls as 1/h, the shape's
/// part grows with a power of h. docs/widths.md explains the limits.
///
/// A continuous function of what was measured, but for its quantiles.
WidthChoice choose_width(const Noise& noise);

/// "none", "noise", "shape", "sheets", "curvature", "extent", "no_surface".
const char* word_for(WidthLimit limit);
/// The same as half a sentence, after "not wider because".
const char* reason_for(WidthLimit limit);

}  // namespace pss
