#pragma once
// A sample of a cloud's positions that depends on nothing but these.

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/lattice.h"

namespace pss {

/// Keeps the distinct positions of smallest hash, whatever order they are shown in.
class PositionSample {
 public:
  explicit PositionSample(std::size_t most) : most_(most) {}

  void add(const Index3& position);
  /// In key order, so that consecutive queries share what lies around.
  std::vector<Index3> positions() const;

 private:
  using Entry = std::pair<std::uint64_t, Index3>;
  std::size_t most_;
  std::set<Entry> chosen_;
};

}  // namespace pss
