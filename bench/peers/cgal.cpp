// CGAL's jet_smooth_point_set: the nearest k, as many as a ball of the radius holds on a plane.

#include <CGAL/Simple_cartesian.h>
#include <CGAL/jet_smooth_point_set.h>

#include <cmath>
#include <numbers>

#include "bench/peers/contender.h"
#include "core/parallel.h"

namespace pss::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using CgalPoints = std::vector<Kernel::Point_3>;

CgalPoints copy_of(const Points& cloud) {
  CgalPoints copy;
  copy.reserve(cloud.points.size());
  for (const Index3& index : cloud.points) {
    const World3 p = to_world(cloud.lattice, index);
    copy.emplace_back(p[0], p[1], p[2]);
  }
  return copy;
}

std::vector<World3> positions_of(const CgalPoints& points) {
  std::vector<World3> positions;
  positions.reserve(points.size());
  for (const Kernel::Point_3& p : points) positions.push_back({p.x(), p.y(), p.z()});
  return positions;
}

class Cgal final : public Contender {
 public:
  std::string name() const override { return "CGAL jet_smooth_point_set"; }

  Smoothed smooth(const Points& cloud, const Task& task) const override {
    const double in_spacings = task.radius / cloud.spacing;
    const auto k = static_cast<unsigned>(std::lround(std::numbers::pi * in_spacings * in_spacings));
    CgalPoints points = copy_of(cloud);
    const auto degree = CGAL::parameters::degree_fitting(static_cast<unsigned>(task.degree));
    const ThreadLimit limit(task.threads);
    Smoothed smoothed;
    const Timer timer;
    if (task.threads > 1)
      CGAL::jet_smooth_point_set<CGAL::Parallel_tag>(points, k, degree);
    else
      CGAL::jet_smooth_point_set<CGAL::Sequential_tag>(points, k, degree);
    smoothed.time = timer.elapsed();
    smoothed.positions = positions_of(points);
    smoothed.neighbours = k;
    return smoothed;
  }
};

}  // namespace

void add_cgal(Contenders& contenders) { contenders.push_back(std::make_unique<Cgal>()); }

}  // namespace pss::bench
