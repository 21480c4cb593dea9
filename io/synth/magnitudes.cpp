#include "io/synth/magnitudes.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pss {
namespace {

// A bin is the exponent and the first seven bits of the mantissa of a magnitude.
constexpr int kMantissaBits = 7;
constexpr int kShift = 52 - kMantissaBits;
constexpr std::size_t kBins = std::size_t{2047} << kMantissaBits;  // all finite magnitudes

std::size_t bin_of(double magnitude) {
  return static_cast<std::size_t>(std::bit_cast<std::uint64_t>(magnitude) >> kShift);
}

double lower_end(std::size_t bin) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(bin) << kShift);
}

}  // namespace

Magnitudes::Magnitudes() : bins_(kBins, 0) {}

void Magnitudes::add(double value) {
  const double magnitude = std::abs(value);
  ++count_;
  sum_ += value;
  squares_ += value * value;
  max_ = std::max(max_, magnitude);
  ++bins_[bin_of(magnitude)];
}

double Magnitudes::rms() const {
  return count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : 0;
}

double Magnitudes::mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; }

double Magnitudes::percentile(double fraction) const {
  if (count_ == 0) return 0;
  const double rank = fraction * static_cast<double>(count_);
  double below = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (bins_[bin] == 0) continue;
    const auto in_bin = static_cast<double>(bins_[bin]);
    if (below + in_bin >= rank) {
      const double part = std::clamp((rank - below) / in_bin, 0.0, 1.0);
      const double low = lower_end(bin);
      return std::min(max_, low + part * (lower_end(bin + 1) - low));
    }
    below += in_bin;
  }
  return max_;
}

}  // namespace pss
