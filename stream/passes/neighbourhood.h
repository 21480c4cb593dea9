#pragma once
// How far an operator looks around each point: a fixed distance, or to its k-th nearest.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "stream/passes/part.h"

namespace pss {

/// The k nearest of each point.
struct NearestRule {
  int k = 0;                ///< positions or points, the point's own excluded
  bool each_point = false;  ///< duplicates of a position count each
  double cap = 0;           ///< a k-th nearest farther than this counts as none
  double first_guess = 0;   ///< a typical distance to the k-th nearest: what is loaded at first
  /// How far a point looks whose k-th nearest lies at a distance; grows with it. Empty: so far.
  std::function<double(double)> reach_at;
};

/// What is loaded around the points of a part, and whether that was enough.
///
/// Thread: const members from any number at once.
class Neighbourhood {
 public:
  /// Nothing around any point.
  Neighbourhood() = default;
  /// All within `reach` of every point.
  static Neighbourhood fixed(double reach);
  /// The k nearest, found for certain however far they are, up to the cap.
  static Neighbourhood nearest(NearestRule rule);
  /// The same, but that nothing farther than `width` is loaded, enough or not.
  Neighbourhood narrowed(double width) const;

  /// Whether parts get k-th distances (Part::kth_distances).
  bool is_nearest() const { return nearest_.k > 0; }
  /// How far any point may look; 0: nowhere.
  double largest_reach() const;
  /// How far own point i of a prepared part looks; below 0 where it has no k nearest.
  double reach_of(const Part& part, std::size_t i) const;

  /// What to load around a part: where its points are not known yet, and for a part whose own
  /// points are loaded.
  std::vector<Surround> around(const PartPlan& plan) const;
  std::vector<Surround> around(const PartPlan& plan, const Part& part) const;

  /// The ball that a grid over a part's candidates should suit. More than 0.
  double grid_radius(const Part& part) const;

  /// Finds the k-th distances of the part's points, as far as that goes with what is loaded;
  /// whether some of part.around have a wider reach now, so that more is to be loaded.
  ///
  /// Requires: part.grid over the candidates.
  bool find_distances(Part& part) const;

  /// What a part holds of this beside its candidates.
  std::uint64_t bytes(const PartPlan& plan) const;

 private:
  double first_reach() const;
  double usual_reach() const;
  double reach_at(double distance) const;
  double guessed_reach(const Lattice& lattice, std::span<const Index3> own,
                       const PointRange& group) const;
  void find_distances(Part& part, Surround& group) const;
  std::optional<double> kth_distance(const CellGrid& grid, const Index3& position,
                                     double cap) const;

  double fixed_ = 0;
  NearestRule nearest_;
  std::optional<double> width_;
};

}  // namespace pss
