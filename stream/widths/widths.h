#pragma once
// Chooses how wide the projection looks: from the user's words, or from measured spacing and noise.

#include <optional>
#include <string>

#include "core/method.h"
#include "core/result.h"
#include "stream/widths/spacing.h"
#include "stream/widths/width_rule.h"

namespace pss {

/// What the user said of widths; what is empty is chosen.
struct WidthOptions {
  std::optional<double> radius;
  std::optional<double> h;
  std::optional<int> knn;
  int degree = 3;
};

/// The widths that a job uses, and why.
struct ChosenWidths {
  double radius = 0;  ///< 0 where each point owns its own
  double h = 0;
  int nearest = 0;                 ///< each point's radius follows from this many neighbours
  double factor = 1;               ///< that radius / the distance to the last of them
  double cap = 0;                  ///< of that distance
  double typical = 0;              ///< a usual value of that distance
  double neighbours = 0;           ///< of a point on a surface of the measured spacing; 0: unknown
  std::string why;                 ///< sentences for the report
  std::optional<Spacing> spacing;  ///< where it was measured
  std::optional<Noise> noise;      ///< where it was measured
  WidthChoice choice;              ///< made of the noise
};

/// Errors: kUsage for widths that make no sense (R < h, --h with --knn, not positive, degree).
Result<void> check_widths(const WidthOptions& options);

/// Whether the choice depends on the measured spacing, and on the measured noise.
bool needs_spacing(const WidthOptions& options);
bool needs_noise(const WidthOptions& options);

/// Requires: checked options; `spacing` where it is needed and could be measured.
///
/// Without `noise`, h is two spacings.
ChosenWidths choose_widths(const WidthOptions& options, const Method& method,
                           const std::optional<Spacing>& spacing,
                           const std::optional<Noise>& noise = std::nullopt);

/// Measures what the choice for this projection needs, and chooses: a pure function of the points.
///
/// Errors: those of sample_spacing() and measure_noise().
Result<ChosenWidths> choose_widths(const Source& source, const WidthOptions& options,
                                   const Method& method, MemoryBudget& budget, Monitor& monitor);

}  // namespace pss
