#include "stream/widths/widths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/support.h"

namespace pss {
namespace {

constexpr int kMostNearest = 10000;
constexpr double kCapSpacings = 10;      ///< default cap of a k-th nearest distance
constexpr double kIsolatedMedians = 16;  ///< a d16 beyond so many medians is isolated

Error usage(std::string message) { return {Fault::kUsage, std::move(message)}; }

ChosenWidths by_hand(const WidthOptions& options, const Method& method) {
  const Support support = options.radius ? support_of_radius(*options.radius, method)
                                         : support_of_h(*options.h, method);
  ChosenWidths widths;
  widths.h = options.h.value_or(support.h);
  widths.radius = support.radius;
  const double factor = radius_over_h(method);
  widths.why = options.radius && options.h ? "radius and h as given"
               : options.h                 ? fmt::format("h as given, radius {} h", factor)
                           : fmt::format("radius as given, h = radius / {}", factor);
  return widths;
}

ChosenWidths by_nearest(const WidthOptions& options, const std::optional<Spacing>& spacing) {
  ChosenWidths widths;
  widths.nearest = *options.knn;
  widths.cap = options.radius.value_or(spacing ? kCapSpacings * spacing->spacing : 0);
  widths.typical =
      spacing ? spacing->spacing * std::sqrt(*options.knn / std::numbers::pi) : widths.cap / 4;
  widths.typical = std::min(widths.typical, widths.cap);
  widths.why =
      fmt::format("each point's radius is the distance to its {}. neighbour, at most {:.6g}",
                  widths.nearest, widths.cap);
  return widths;
}

ChosenWidths by_varying_spacing(const Method& method, const Spacing& spacing,
                                const WidthChoice& choice) {
  const Support support = support_of_width(choice.multiple, method);
  ChosenWidths widths;
  widths.nearest = kSpacingRank;
  // What a point measures of its own counts each twin.
  widths.factor = support.radius * spacing_of_d16(1) * spacing.twins;
  widths.cap = kIsolatedMedians * spacing.d16;
  widths.typical = spacing.d16;
  widths.why = fmt::format(
      "the spacing varies ({:.4g} to {:.4g} between its 10th and 90th percentile), so each point's "
      "h is {:.3g} times its own, from its {}. neighbour",
      spacing_of_d16(spacing.d16_low), spacing_of_d16(spacing.d16_high), support.h, kSpacingRank);
  return widths;
}

ChosenWidths by_spacing(const Method& method, const Spacing& spacing, const WidthChoice& choice) {
  const Support support = support_of_width(choice.multiple, method);
  ChosenWidths widths;
  widths.h = support.h * spacing.spacing;
  widths.radius = support.radius * spacing.spacing;
  widths.why = fmt::format(
      "h is {:.3g} times the measured spacing of {:.4g} ({} sampled positions), radius {} h",
      support.h, spacing.spacing, spacing.sample, radius_over_h(method));
  return widths;
}

/// What was seen of the noise and what that made of the width.
std::string reasons(const Noise& noise, const WidthChoice& choice) {
  if (choice.limit == WidthLimit::kNoSurface)
    return fmt::format("no surface seen within {} spacings: too few points, or they fill a volume",
                       kWidest);
  std::string text =
      noise.first < 0 ? "noise unknown" : fmt::format("noise {:.2g} spacings", noise.sigma);
  if (choice.limit == WidthLimit::kNone) return text + "; the widest that is chosen";
  text += fmt::format("; not wider because {}", reason_for(choice.limit));
  if (choice.limit == WidthLimit::kSheets)
    text += fmt::format(", {:.2g} spacings away", noise.apart);
  return text;
}

ChosenWidths by_measuring(const Method& method, const Spacing& spacing,
                          const std::optional<Noise>& noise) {
  const WidthChoice choice = noise ? choose_width(*noise) : WidthChoice{};
  ChosenWidths widths = spacing.varying() ? by_varying_spacing(method, spacing, choice)
                                          : by_spacing(method, spacing, choice);
  const double radius = support_of_width(choice.multiple, method).radius;
  widths.neighbours = std::numbers::pi * radius * radius * spacing.twins * spacing.twins;
  if (noise)
    widths.why += fmt::format("; {}; about {:.0f} neighbours a point", reasons(*noise, choice),
                              widths.neighbours);
  widths.noise = noise;
  widths.choice = choice;
  return widths;
}

}  // namespace

Result<void> check_widths(const WidthOptions& options) {
  if (options.degree < 0 || options.degree > 4)
    return usage(fmt::format("--polynomial-order: found {}, expected 0 to 4", options.degree));
  for (const auto& [name, value] : {std::pair{"--radius", options.radius}, {"--h", options.h}})
    if (value && !(*value > 0 && std::isfinite(*value)))
      return usage(fmt::format("{}: found {}, expected a length above zero", name, *value));
  if (options.knn && (*options.knn < 1 || *options.knn > kMostNearest))
    return usage(fmt::format("--knn: found {}, expected 1 to {}", *options.knn, kMostNearest));
  if (options.knn && options.h)
    return usage("--h does not go with --knn, where each point's h follows from its own radius");
  if (options.radius && options.h && *options.radius < *options.h)
    return usage(
        fmt::format("--radius {} is smaller than --h {}; expected at least h, usually {} h",
                    *options.radius, *options.h, radius_factor(options.degree)));
  return {};
}

bool needs_spacing(const WidthOptions& options) { return !options.radius && !options.h; }

bool needs_noise(const WidthOptions& options) { return needs_spacing(options) && !options.knn; }

ChosenWidths choose_widths(const WidthOptions& options, const Method& method,
                           const std::optional<Spacing>& spacing,
                           const std::optional<Noise>& noise) {
  ChosenWidths widths;
  if (!needs_spacing(options)) {
    widths = options.knn ? by_nearest(options, spacing) : by_hand(options, method);
  } else if (!spacing) {
    widths.why = fmt::format("fewer than {} distinct positions: no spacing, nothing moves",
                             kSpacingRank + 1);
  } else if (options.knn) {
    widths = by_nearest(options, spacing);
  } else {
    widths = by_measuring(method, *spacing, noise);
  }
  widths.spacing = spacing;
  return widths;
}

Result<ChosenWidths> choose_widths(const Source& source, const WidthOptions& options,
                                   const Method& method, MemoryBudget& budget, Monitor& monitor) {
  if (!needs_spacing(options)) return choose_widths(options, method, std::nullopt);
  PSS_ASSIGN(const SpacingSample sample, sample_spacing(source, budget, monitor));
  std::optional<Noise> noise;
  if (sample.spacing && needs_noise(options)) {
    PSS_ASSIGN(noise, measure_noise(source, sample, method, budget, monitor));
  }
  return choose_widths(options, method, sample.spacing, noise);
}

}  // namespace pss
