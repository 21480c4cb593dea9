#include "stream/widths/width_rule.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "stream/widths/sheets.h"

namespace pss {
namespace {

constexpr double kNoiseOfWidest = 0.1;      ///< spacings: from here on noise is worth any width
constexpr double kNoiseOfNarrowest = 0.01;  ///< up to here it is worth none
constexpr double kMostBend = 0.5;           ///< h times curvature
constexpr double kLeastUsable = 0.5;        ///< of the share that the first width could use
constexpr double kFoundByChance = 1.15;     ///< a change so many times that of noise shows shape
constexpr double kLeastBalance = 1e-3;

double power(double base, double exponent) { return exp(exponent * log(base)); }

/// The part of shape in the change between a width and the next: what noise does not explain.
double shape_change(const WidthTrial& trial, double sigma) {
  const double noise = kFoundByChance * trial.noise_change * sigma;
  return std::sqrt(std::max(0.0, trial.change * trial.change - noise * noise));
}

std::size_t first_of(const Noise& noise) { return static_cast<std::size_t>(noise.first); }

/// How the error falls and grows with the width.
///
/// Between two tried widths shape adds b (h2^p - h1^p), which gives b. The sum of the squares of
/// c sigma / h and b h^p is least where sqrt(p) b h^p equals c sigma / h: the balance is 1.
class Balance {
 public:
  explicit Balance(const Noise& noise) : noise_(noise), order_(noise.order) {}

  /// The width at which the balance is 1: log-linear between the middles of pairs of tried widths,
  /// by its power law before the first and after the last.
  double width() const {
    const std::size_t pairs = noise_.trials.size() - 1;
    const std::size_t first = first_of(noise_);
    if (first >= pairs) return kWidest;
    for (std::size_t k = first; k < pairs; ++k) {
      const double here = balance(k);
      if (here < 1) continue;
      if (k == first) return by_power_law(k);
      const double before = balance(k - 1);
      const double share = -log(before) / (log(here) - log(before));
      return middle(k - 1) * power(middle(k) / middle(k - 1), share);
    }
    return by_power_law(pairs - 1);
  }

  /// What is left at a width, by noise alone.
  double noise_at(double width) const { return noise_.kept * noise_.sigma / width; }

 private:
  double middle(std::size_t k) const {
    return std::sqrt(noise_.trials[k].width * noise_.trials[k + 1].width);
  }

  double balance(std::size_t k) const {
    const double narrow = power(noise_.trials[k].width, order_);
    const double wide = power(noise_.trials[k + 1].width, order_);
    const double shape =
        shape_change(noise_.trials[k], noise_.sigma) / (wide - narrow) * power(middle(k), order_);
    const double noise = noise_at(middle(k));
    if (noise <= 0) return 1 / kLeastBalance;
    return std::clamp(std::sqrt(order_) * shape / noise, kLeastBalance, 1 / kLeastBalance);
  }

  double by_power_law(std::size_t k) const {
    return middle(k) * power(balance(k), -1.0 / (order_ + 1));
  }

  const Noise& noise_;
  double order_;
};

/// Widths beyond which noise of this size is not worth the neighbours that they take.
double worth_of(double sigma) {
  if (sigma <= kNoiseOfNarrowest) return kNarrowest;
  const double exponent = log(kWidest / kNarrowest) / log(kNoiseOfWidest / kNoiseOfNarrowest);
  return kNarrowest * power(sigma / kNoiseOfNarrowest, exponent);
}

/// The width where a measured value, linear between tried widths, first crosses a bound; the
/// widest where it never does.
template <class Value>
double crossing(const Noise& noise, double bound, Value value) {
  for (std::size_t k = first_of(noise) + 1; k < noise.trials.size(); ++k) {
    const double before = value(noise.trials[k - 1]);
    const double here = value(noise.trials[k]);
    if ((here > bound) == (before > bound)) continue;
    const double share = (bound - before) / (here - before);
    return (1 - share) * noise.trials[k - 1].width + share * noise.trials[k].width;
  }
  return kWidest;
}

double by_curvature(const Noise& noise) {
  const auto bend = [](const WidthTrial& trial) { return trial.bend; };
  const WidthTrial& first = noise.trials[first_of(noise)];
  if (bend(first) > kMostBend) return first.width;
  return crossing(noise, kMostBend, bend);
}

double by_extent(const Noise& noise) {
  const double least = kLeastUsable * noise.trials[first_of(noise)].usable;
  return crossing(noise, least, [](const WidthTrial& trial) { return trial.usable; });
}

}  // namespace

WidthChoice choose_width(const Noise& noise) {
  WidthChoice choice;
  if (noise.first < 0 && noise.apart > 0) choice.limit = WidthLimit::kSheets;
  if (noise.first < 0) return choice;
  const double least = noise.trials[first_of(noise)].width;
  const Balance balance(noise);
  choice = {kWidest, WidthLimit::kNone, 0};
  const auto limit = [&](double width, WidthLimit what) {
    if (width < choice.multiple) choice = {std::max(width, least), what, 0};
  };
  limit(worth_of(noise.sigma), WidthLimit::kNoise);
  limit(balance.width(), WidthLimit::kShape);
  limit(by_curvature(noise), WidthLimit::kCurvature);
  limit(by_extent(noise), WidthLimit::kExtent);
  if (noise.apart > 0) limit(noise.apart / kWidthsApart, WidthLimit::kSheets);
  choice.error = balance.noise_at(choice.multiple);
  return choice;
}

const char* word_for(WidthLimit limit) {
  switch (limit) {
    case WidthLimit::kNone:
      return "none";
    case WidthLimit::kNoise:
      return "noise";
    case WidthLimit::kShape:
      return "shape";
    case WidthLimit::kSheets:
      return "sheets";
    case WidthLimit::kCurvature:
      return "curvature";
    case WidthLimit::kExtent:
      return "extent";
    case WidthLimit::kNoSurface:
      return "no_surface";
  }
  return "";
}

const char* reason_for(WidthLimit limit) {
  switch (limit) {
    case WidthLimit::kNone:
      return "none wider is chosen";
    case WidthLimit::kNoise:
      return "so little noise is not worth more neighbours";
    case WidthLimit::kShape:
      return "wider fits would bend the surface more than they calm it";
    case WidthLimit::kSheets:
      return "a tenth of the points have another sheet near";
    case WidthLimit::kCurvature:
      return "the surface turns too much within wider fits";
    case WidthLimit::kExtent:
      return "wider fits reach boundaries";
    case WidthLimit::kNoSurface:
      return "no width shows a surface";
  }
  return "";
}

}  // namespace pss
