#pragma once
// What is compared: a way to smooth a whole cloud, timed from the input's points to new positions.

#include <chrono>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "bench/peers/cloud.h"

namespace pss::bench {

/// What to do with a cloud; the same for all contenders.
struct Task {
  double radius = 0;
  int degree = 3;
  int threads = 1;
};

/// Seconds on the wall, and on processors.
struct Time {
  double wall = 0;
  double cpu = 0;
};

/// Times since it was made.
class Timer {
 public:
  Time elapsed() const {
    const auto wall = std::chrono::steady_clock::now() - start_;
    return {std::chrono::duration<double>(wall).count(),
            static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC};
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::clock_t cpu_start_ = std::clock();
};

struct Smoothed {
  std::vector<World3> positions;  ///< in the order of the points; NaN for what got none
  Time time;                      ///< of everything but copying the input to the contender's type
  Time sort;                      ///< the part of `time` that points in key order would save
  double neighbours = 0;          ///< mean over the points
  std::size_t kept = 0;           ///< points returned as they came, for what their status says
};

class Contender {
 public:
  virtual ~Contender() = default;
  virtual std::string name() const = 0;
  /// Whether it is another's program, against which pss is measured.
  virtual bool peer() const { return true; }
  virtual Smoothed smooth(const Points& cloud, const Task& task) const = 0;
};

using Contenders = std::vector<std::unique_ptr<Contender>>;

/// PCL's MovingLeastSquares; nothing is added where the build found no PCL. Likewise CGAL's
/// jet_smooth_point_set, with as many neighbours as the ball holds on an even surface.
void add_pcl(Contenders& contenders);
void add_cgal(Contenders& contenders);
void add_pss(Contenders& contenders);

}  // namespace pss::bench
