#pragma once
// Exact sums of many small integers and of their squares: mean and deviation in any order of terms.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pss {

/// Sums of values below 2^32 over up to 2^40 of them, without rounding.
class FixedSums {
 public:
  void add(std::uint32_t value);
  void add(const FixedSums& other);

  std::uint64_t count() const { return count_; }
  /// Units: those of the values. 0 where there are none.
  double mean() const;
  /// The sample's standard deviation (n - 1); 0 where there are fewer than two.
  double deviation() const;

  /// A fixed number of bytes.
  std::vector<std::byte> to_bytes() const;
  /// Bytes of another length give empty sums.
  static FixedSums from_bytes(std::span<const std::byte> bytes);

 private:
  __extension__ using Wide = unsigned __int128;
  std::uint64_t count_ = 0;
  Wide sum_ = 0;
  Wide squares_ = 0;
};

}  // namespace pss
