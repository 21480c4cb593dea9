#pragma once
// A hilly surface z = f(x, y), the sum of a few waves, that can be sampled evenly by area.

#include <array>
#include <vector>

#include "core/lattice.h"

namespace pss {

/// A height and its derivatives up to the second order.
struct Height {
  double z = 0;
  double x = 0, y = 0;
  double xx = 0, xy = 0, yy = 0;
};

/// Maps the unit square to itself so that even points become points of a given density.
///
/// The density is interpolated from a table: linearly in x, by constant pieces in y. The map is
/// continuous, so that evenly spaced points stay so.
class DensityMap {
 public:
  static constexpr std::size_t kCells = 256;

  /// Shape: `density` has (kCells + 1)^2 positive values at the nodes, y fastest.
  explicit DensityMap(const std::vector<double>& density);

  /// The integral of the density over the unit square.
  double total() const { return marginal_.back(); }

  std::array<double, 2> map(double u, double v) const;

 private:
  const double* column(std::size_t x) const { return &columns_[x * (kCells + 1)]; }

  std::vector<double> columns_;   ///< for every node in x the integral over y up to every node
  std::vector<double> marginal_;  ///< the integral over x up to every node of the whole column
};

/// A rectangle of hills about the origin; the function goes on beyond it, the samples do not.
class Terrain {
 public:
  /// Units: the hills are as high as 0.056 width, with slopes up to 0.73.
  explicit Terrain(double width = 1000, double depth = 1000);

  double width() const { return width_; }
  double depth() const { return depth_; }
  double area() const { return width_ * depth_ * map_.total(); }
  /// No height is above this, none below its negative.
  double amplitude() const;
  Height height(double x, double y) const;

  /// The place of the sample (u, v) of the unit square.
  std::array<double, 2> place(double u, double v) const;

  /// Where the surface is nearest to `p`: certain near the surface, the best found far from it.
  std::array<double, 2> nearest(const World3& p) const;

 private:
  double distance_sq(const World3& p, double x, double y) const;
  /// The local minimum of the distance to `p` below a place.
  std::array<double, 2> descend(const World3& p, double x, double y) const;

  double width_, depth_;
  DensityMap map_;
};

}  // namespace pss
