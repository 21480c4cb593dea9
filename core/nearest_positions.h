#pragma once
// The k positions nearest to a query, whatever order they are shown in.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/lattice.h"

namespace pss {

/// The squared distance of a position, and the position: ordered by distance, then by place.
using Neighbour = std::pair<double, Index3>;

/// Keeps the k first of the distinct neighbours that it is shown.
class NearestPositions {
 public:
  static constexpr bool kEachPoint = false;  ///< duplicates of a position count once

  explicit NearestPositions(std::size_t k) : k_(k) { found_.reserve(k + 1); }

  bool full() const { return found_.size() == k_; }
  /// The largest squared distance among them. Requires: some.
  double largest() const { return found_.back().first; }
  void clear() { found_.clear(); }

  void add(double distance_sq, const Index3& position) {
    const Neighbour entry{distance_sq, position};
    if (full() && !(entry < found_.back())) return;
    const auto place = std::lower_bound(found_.begin(), found_.end(), entry);
    if (place != found_.end() && *place == entry) return;
    found_.insert(place, entry);
    if (found_.size() > k_) found_.pop_back();
  }

  /// In their order.
  std::vector<Neighbour> take() { return std::move(found_); }

 private:
  std::size_t k_;
  std::vector<Neighbour> found_;  ///< sorted
};

}  // namespace pss
