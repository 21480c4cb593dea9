#include "stream/passes/key_groups.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/morton.h"

namespace pss {
namespace {

/// Deeper than any order by key goes: what lies deeper is cut in halves.
constexpr int kDeepest = 3 * kLatticeBits;

/// How far the order leaps between two positions: the highest bit in which their keys differ, and
/// 0 for equal ones.
std::uint8_t leap(const Key& a, const Key& b) {
  if (a.high != b.high) return static_cast<std::uint8_t>(128 - std::countl_zero(a.high ^ b.high));
  return static_cast<std::uint8_t>(64 - std::countl_zero(a.low ^ b.low));
}

class Cutter {
 public:
  Cutter(std::span<const Index3> positions, std::size_t most) : most_(most) {
    leaps_.reserve(positions.size());
    Key last{};
    for (const Index3& position : positions) {
      const Key key = encode_key(position);
      leaps_.push_back(leaps_.empty() ? std::uint8_t{0} : leap(last, key));
      last = key;
    }
    cut({0, positions.size()}, 0);
  }

  std::vector<PointRange> take() { return std::move(groups_); }

 private:
  void cut(const PointRange& range, int depth) {
    if (range.begin == range.end) return;
    if (range.end - range.begin <= most_) return groups_.push_back(range);
    const auto first = leaps_.begin() + static_cast<std::ptrdiff_t>(range.begin);
    const auto last = leaps_.begin() + static_cast<std::ptrdiff_t>(range.end);
    const auto farthest = std::max_element(first + 1, last);
    if (*farthest == 0) return groups_.push_back(range);
    const std::size_t middle = depth < kDeepest
                                   ? static_cast<std::size_t>(farthest - leaps_.begin())
                                   : range.begin + (range.end - range.begin) / 2;
    cut({range.begin, middle}, depth + 1);
    cut({middle, range.end}, depth + 1);
  }

  std::size_t most_;
  std::vector<std::uint8_t> leaps_;  ///< from the point before
  std::vector<PointRange> groups_;
};

}  // namespace

std::vector<PointRange> key_groups(std::span<const Index3> positions, std::size_t most) {
  return Cutter(positions, most).take();
}

}  // namespace pss
