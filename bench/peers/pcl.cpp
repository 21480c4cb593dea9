// PCL's MovingLeastSquares, set to what it does fastest: positions only, unsorted neighbours.

#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <limits>

#include "bench/peers/contender.h"

namespace pss::bench {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
using Tree = pcl::search::KdTree<pcl::PointXYZ>;

constexpr std::size_t kSampleStride = 37;

PclCloud::Ptr copy_of(const Points& cloud) {
  PclCloud::Ptr copy(new PclCloud);
  copy->reserve(cloud.points.size());
  for (const Index3& index : cloud.points) {
    const World3 p = to_world(cloud.lattice, index);  // exact, like its floats
    copy->emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]),
                       static_cast<float>(p[2]));
  }
  return copy;
}

/// PCL leaves out points with too few neighbours; `rows` says which are there.
std::vector<World3> positions_of(const PclCloud& cloud, const pcl::Indices& rows,
                                 std::size_t count) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<World3> positions(count, {kNone, kNone, kNone});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const pcl::PointXYZ& p = cloud[i];
    positions[static_cast<std::size_t>(rows[i])] = {p.x, p.y, p.z};
  }
  return positions;
}

/// The mean number of neighbours of every so many-th point: PCL keeps no count without its cache.
double count_neighbours(const PclCloud& cloud, const Tree& tree, double radius) {
  pcl::Indices indices;
  std::vector<float> distances;
  std::size_t found = 0, queries = 0;
  for (std::size_t i = 0; i < cloud.size(); i += kSampleStride, ++queries)
    found += static_cast<std::size_t>(tree.radiusSearch(cloud[i], radius, indices, distances));
  return static_cast<double>(found) / static_cast<double>(queries);
}

class Pcl final : public Contender {
 public:
  std::string name() const override { return "PCL MovingLeastSquares"; }

  Smoothed smooth(const Points& cloud, const Task& task) const override {
    const PclCloud::Ptr input = copy_of(cloud);
    const Tree::Ptr tree(new Tree(false));
    PclCloud output;
    Smoothed smoothed;
    const Timer timer;
    pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointXYZ> mls;
    mls.setInputCloud(input);
    mls.setSearchMethod(tree);
    mls.setSearchRadius(task.radius);
    mls.setPolynomialOrder(task.degree);
    mls.setNumberOfThreads(static_cast<unsigned>(task.threads));
    // Threads that share the one result it has without a cache crash; one thread is faster so.
    mls.setCacheMLSResults(task.threads > 1);
    mls.process(output);
    smoothed.time = timer.elapsed();
    smoothed.positions =
        positions_of(output, mls.getCorrespondingIndices()->indices, input->size());
    smoothed.neighbours = count_neighbours(*input, *tree, task.radius);
    return smoothed;
  }
};

}  // namespace

void add_pcl(Contenders& contenders) { contenders.push_back(std::make_unique<Pcl>()); }

}  // namespace pss::bench
