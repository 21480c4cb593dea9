#include "stream/widths/noise.h"

#include <algorithm>
#include <cmath>

#include "core/fit_kernel.h"
#include "core/projection.h"

namespace pss {
namespace {

constexpr std::size_t kTrials = kTriedWidths.size();
constexpr double kThick = 0.25;        ///< noise over h, above which a fit sees no surface
constexpr double kKept = 0.9;          ///< of squared changes: the rest may be edges or outliers
constexpr double kKeptShare = 0.6228;  ///< of their mean, for a normal distribution
constexpr std::size_t kFewest = 32;    ///< sampled positions that tell anything

/// Odd moments vanish: an odd degree is as good as the next even one.
int shape_order(int degree) { return degree < 2 ? 2 : degree < 4 ? 4 : 6; }

/// The element with `share` of the others below it; 0 where there are none.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

template <class Value>
std::vector<double> undisturbed(const std::vector<Reading>& readings, Value value) {
  std::vector<double> values;
  for (const Reading& reading : readings)
    if (reading.usable && !reading.disturbed) values.push_back(value(reading));
  return values;
}

/// The variance of the noise that leaves this residual: a fit with so many neighbours takes a share
/// of it, and the median of its squares lies below their mean.
double variance_of(const Reading& reading, double h, const FitKernel& kernel) {
  const double per_sample = reading.area / (h * h);
  const double left = 1 - std::min(0.9, kernel.absorbed() * per_sample);
  const double freedom = std::max(1.0, kernel.samples() / per_sample * left);
  // Wilson, Hilferty: the median of a chi square over its degrees of freedom.
  const double median = 1 - 2 / (9 * freedom);
  return reading.residual_sq / (left * median * median * median);
}

/// Neighbours off the surface weigh less, so that the weighted variance m is below the noise's v:
/// 1/m = 1/v + 2/h^2. Far above what counts as a surface where no v would do.
double unweighted(double variance, double h) {
  return variance / std::max(0.1, 1 - 2 * variance / (h * h));
}

/// The root of the mean of the smaller squares, as if they were of a normal distribution.
double robust_rms(std::vector<double> squares) {
  const auto kept = static_cast<std::size_t>(kKept * static_cast<double>(squares.size()));
  if (kept == 0) return 0;
  std::ranges::sort(squares);
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) sum += squares[i];
  return std::sqrt(sum / static_cast<double>(kept) / kKeptShare);
}

/// What noise of one unit changes between this width and the next.
double noise_change(const std::vector<Reading>& readings, std::size_t trial,
                    const FitKernel& kernel) {
  double area = 0;
  std::size_t count = 0;
  for (const Reading& reading : readings) {
    if (!reading.change_sq) continue;
    area += reading.area;
    ++count;
  }
  if (count == 0) return 0;
  return std::sqrt(area / static_cast<double>(count) *
                   kernel.difference_sq(kTriedWidths[trial], kTriedWidths[trial + 1]));
}

WidthTrial summary_of(const std::vector<Reading>& readings, std::size_t trial,
                      const FitKernel& kernel) {
  WidthTrial result;
  const double h = result.width = kTriedWidths[trial];
  const std::vector<double> variances =
      undisturbed(readings, [&](const Reading& r) { return variance_of(r, h, kernel); });
  result.usable = static_cast<double>(std::ranges::count(readings, true, &Reading::usable)) /
                  static_cast<double>(readings.size());
  result.known = variances.size() >= kFewest;
  if (!result.known) return result;
  result.residual = std::sqrt(unweighted(quantile(variances, 0.5), h));
  result.bend = quantile(undisturbed(readings, [](const Reading& r) { return r.bend; }), 0.9);
  if (trial + 1 == kTrials) return result;
  std::vector<double> changes;
  for (const Reading& reading : readings)
    if (reading.change_sq) changes.push_back(*reading.change_sq);
  result.change = robust_rms(std::move(changes));
  result.noise_change = noise_change(readings, trial, kernel);
  return result;
}

/// The noise at the narrowest width that sees a surface.
///
/// Of what the fit leaves, shape grows with the width as h^(degree + 1), noise does not: the next
/// width tells them apart.
void find_sigma(int degree, Noise& noise) {
  for (std::size_t k = 0; k < noise.trials.size() && noise.first < 0; ++k) {
    const WidthTrial& trial = noise.trials[k];
    if (!trial.known || !(trial.residual < kThick * trial.width)) continue;
    noise.first = static_cast<int>(k);
    double variance = trial.residual * trial.residual;
    if (k + 1 < noise.trials.size() && noise.trials[k + 1].known) {
      const WidthTrial& next = noise.trials[k + 1];
      double ratio = 1;  // of the squares of what shape leaves
      for (int i = 0; i < 2 * std::max(2, degree + 1); ++i) ratio *= next.width / trial.width;
      const double growth = next.residual * next.residual - variance;
      variance -= std::clamp(growth / (ratio - 1), 0.0, variance);
    }
    noise.sigma = std::sqrt(variance);
  }
}

Noise noise_in(const Readings& readings, const Method& method) {
  Noise noise;
  noise.sample = readings.sample();
  if (noise.sample < kFewest) return noise;
  const FitKernel kernel(method.weight, method.degree, radius_factor(method.degree));
  noise.kept = std::sqrt(kernel.noise_sq());
  noise.order = shape_order(method.degree);
  for (std::size_t k = 0; k < kTrials; ++k)
    noise.trials.push_back(summary_of(readings.at[k], k, kernel));
  find_sigma(method.degree, noise);
  // A tenth of all: the quantile among those that see another sheet.
  const double tenth = 0.1 * static_cast<double>(noise.sample);
  const auto seen = static_cast<double>(readings.sheets.size());
  if (seen > tenth) noise.apart = quantile(readings.sheets, tenth / seen);
  return noise;
}

}  // namespace

Result<Noise> measure_noise(const Source& source, const SpacingSample& sample, const Method& method,
                            MemoryBudget& budget, Monitor& monitor) {
  PSS_ASSIGN(const Readings readings, try_widths(source, sample, method, budget, monitor));
  return noise_in(readings, method);
}

}  // namespace pss
