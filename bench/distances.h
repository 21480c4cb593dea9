#pragma once
// How far two results for the same points lie apart.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/projection.h"
#include "core/vec3.h"

namespace pss::bench {

/// Distances in spacings, of points that are ok in both results.
class Distances {
 public:
  explicit Distances(double spacing) : spacing_(spacing) {}

  void add(const Projection& a, const Projection& b) {
    statuses_ += a.status != b.status;
    if (a.status == Status::kOk && b.status == Status::kOk) add(a.displacement - b.displacement);
  }

  void add(const World3& apart) {
    const double distance = std::sqrt(dot(apart, apart)) / spacing_;
    ++compared_;
    far_ += distance > 1e-4;
    elsewhere_ += distance > 0.01;
    worst_ = std::max(worst_, distance);
    square_ += distance * distance;
  }

  std::size_t compared() const { return compared_; }
  std::size_t statuses() const { return statuses_; }    ///< that differ
  std::size_t far() const { return far_; }              ///< more than 1e-4
  std::size_t elsewhere() const { return elsewhere_; }  ///< more than 0.01
  double worst() const { return worst_; }
  double rms() const { return compared_ ? std::sqrt(square_ / static_cast<double>(compared_)) : 0; }

 private:
  double spacing_;
  std::size_t compared_ = 0, statuses_ = 0, far_ = 0, elsewhere_ = 0;
  double worst_ = 0, square_ = 0;
};

}  // namespace pss::bench
