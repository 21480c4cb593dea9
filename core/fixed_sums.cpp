#include "core/fixed_sums.h"

#include <cmath>
#include <cstring>

namespace pss {
namespace {

__extension__ using Signed = __int128;

}  // namespace

void FixedSums::add(std::uint32_t value) {
  ++count_;
  sum_ += value;
  squares_ += static_cast<std::uint64_t>(value) * value;
}

void FixedSums::add(const FixedSums& other) {
  count_ += other.count_;
  sum_ += other.sum_;
  squares_ += other.squares_;
}

double FixedSums::mean() const {
  if (count_ == 0) return 0;
  const auto whole = static_cast<std::uint64_t>(sum_ / count_);
  const auto rest = static_cast<std::uint64_t>(sum_ % count_);
  return static_cast<double>(whole) + static_cast<double>(rest) / static_cast<double>(count_);
}

/// About the whole part m of the mean, so that nothing large cancels in floating point: the sum of
/// (v - m)^2 is squares - 2 m sum + n m^2, exact below 2^106, and the rest of the mean is below 1.
double FixedSums::deviation() const {
  if (count_ < 2) return 0;
  const auto m = static_cast<Signed>(sum_ / count_);
  const auto n = static_cast<double>(count_);
  const double rest = static_cast<double>(static_cast<std::uint64_t>(sum_ % count_));
  const Signed about = static_cast<Signed>(squares_) - 2 * m * static_cast<Signed>(sum_) +
                       static_cast<Signed>(count_) * m * m;
  return std::sqrt((static_cast<double>(about) - rest * rest / n) / (n - 1));
}

std::vector<std::byte> FixedSums::to_bytes() const {
  std::vector<std::byte> bytes(sizeof count_ + sizeof sum_ + sizeof squares_);
  std::memcpy(bytes.data(), &count_, sizeof count_);
  std::memcpy(bytes.data() + sizeof count_, &sum_, sizeof sum_);
  std::memcpy(bytes.data() + sizeof count_ + sizeof sum_, &squares_, sizeof squares_);
  return bytes;
}

FixedSums FixedSums::from_bytes(std::span<const std::byte> bytes) {
  FixedSums sums;
  if (bytes.size() != sizeof sums.count_ + sizeof sums.sum_ + sizeof sums.squares_) return sums;
  std::memcpy(&sums.count_, bytes.data(), sizeof sums.count_);
  std::memcpy(&sums.sum_, bytes.data() + sizeof sums.count_, sizeof sums.sum_);
  std::memcpy(&sums.squares_, bytes.data() + sizeof sums.count_ + sizeof sums.sum_,
              sizeof sums.squares_);
  return sums;
}

}  // namespace pss
