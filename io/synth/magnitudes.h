#pragma once
// Statistics of many errors in bounded memory: rms, mean, largest, percentiles.

#include <cstdint>
#include <vector>

namespace pss {

/// Magnitudes summed up one by one: rms, mean, largest and percentiles, in bounded memory.
///
/// Percentiles come from a histogram of 128 bins an octave: within 0.8 %.
class Magnitudes {
 public:
  Magnitudes();

  /// Requires: `value` finite. Its sign counts in the mean alone.
  void add(double value);

  std::uint64_t count() const { return count_; }
  double rms() const;
  double mean() const;
  double max() const { return max_; }
  /// The magnitude that `fraction` of all do not exceed; 0 where there are none.
  double percentile(double fraction) const;

 private:
  std::uint64_t count_ = 0;
  double sum_ = 0;
  double squares_ = 0;
  double max_ = 0;
  std::vector<std::uint64_t> bins_;
};

}  // namespace pss
