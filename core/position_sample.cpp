#include "core/position_sample.h"

#include <algorithm>
#include <iterator>

#include "core/morton.h"

namespace pss {
namespace {

/// A fixed mixing of a position's key; nothing but the position decides it.
std::uint64_t hash_position(const Index3& position) {
  const Key key = encode_key(position);
  std::uint64_t h = key.high * 0x9e3779b97f4a7c15 ^ key.low;
  for (const std::uint64_t factor : {0xbf58476d1ce4e5b9, 0x94d049bb133111eb}) {
    h = (h ^ h >> 31) * factor;
  }
  return h ^ h >> 29;
}

}  // namespace

void PositionSample::add(const Index3& position) {
  const Entry entry{hash_position(position), position};
  if (chosen_.size() == most_ && !(entry < *chosen_.rbegin())) return;
  chosen_.insert(entry);
  if (chosen_.size() > most_) chosen_.erase(std::prev(chosen_.end()));
}

std::vector<Index3> PositionSample::positions() const {
  std::vector<Index3> positions;
  for (const Entry& entry : chosen_) positions.push_back(entry.second);
  std::ranges::sort(positions, {}, encode_key);
  return positions;
}

}  // namespace pss
