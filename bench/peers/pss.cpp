// pss in memory: sort by key, cell grid, projection of every point, results in the input's order.

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "bench/peers/contender.h"
#include "core/key_sort.h"
#include "core/morton.h"
#include "core/parallel.h"
#include "core/projector.h"
#include "core/spares.h"
#include "core/support.h"

namespace pss::bench {
namespace {

constexpr std::size_t kChunk = 4096;  // points a projector takes at once

/// Leaves new elements as they come, so that those who fill an array in parallel touch it first.
template <class T>
struct Unfilled : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Unfilled<U>;
  };
  template <class U>
  void construct(U*) const noexcept {}
};

template <class T>
using Array = std::vector<T, Unfilled<T>>;

/// Points in key order, and the place of each in the input.
struct Sorted {
  Array<Index3> points;
  Array<std::uint32_t> rows;
};

Sorted sort_points(const std::vector<Index3>& points) {
  const std::size_t n = points.size();
  Array<Key> keys(n);
  parallel_for(n, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) keys[i] = encode_key(points[i]);
  });
  Array<KeyEntry> entries(n), scratch(n);
  // Only a monitor that stops makes it fail.
  static_cast<void>(sort_keys(keys, entries, scratch));
  Sorted sorted{Array<Index3>(n), Array<std::uint32_t>(n)};
  parallel_for(n, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      sorted.rows[i] = entries[i].index;
      sorted.points[i] = points[entries[i].index];
    }
  });
  return sorted;
}

/// Projects the points of one cloud, range by range.
class Pass {
 public:
  Pass(const Points& cloud, const Sorted& sorted, const Method& method, const Support& support)
      : cloud_(cloud),
        sorted_(sorted),
        method_(method),
        support_(support),
        grid_(cloud.lattice, sorted.points, reach(method.weight, support)) {
    smoothed_.positions.resize(sorted.points.size());
  }

  Smoothed run() {
    const std::size_t n = sorted_.points.size();
    parallel_for(n, kChunk, [&](std::size_t begin, std::size_t end) { project(begin, end); });
    smoothed_.neighbours = static_cast<double>(neighbours_) / static_cast<double>(n);
    return std::move(smoothed_);
  }

 private:
  /// What a thread needs again for its next range.
  struct Worker {
    explicit Worker(const Pass& pass)
        : projector(pass.grid_, pass.method_), queries(kChunk), results(kChunk) {}

    Projector projector;
    std::vector<Query> queries;
    std::vector<Projection> results;
  };

  void project(std::size_t begin, std::size_t end) {
    std::unique_ptr<Worker> worker = idle_.take();
    if (!worker) worker = std::make_unique<Worker>(*this);
    const std::span queries = std::span(worker->queries).first(end - begin);
    const std::span results = std::span(worker->results).first(end - begin);
    for (std::size_t i = begin; i < end; ++i) queries[i - begin].position = sorted_.points[i];
    worker->projector.project(queries, std::span(&support_, 1), results);
    put(begin, results);
    idle_.give(std::move(worker));
  }

  void put(std::size_t begin, std::span<const Projection> results) {
    std::uint64_t neighbours = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      World3 p = to_world(cloud_.lattice, sorted_.points[begin + i]);
      for (std::size_t a = 0; a < 3; ++a) p[a] += results[i].displacement[a];
      smoothed_.positions[sorted_.rows[begin + i]] = p;
      neighbours += results[i].neighbours;
      kept += moved(results[i].status) ? 0 : 1;
    }
    const std::scoped_lock lock(mutex_);
    neighbours_ += neighbours;
    smoothed_.kept += kept;
  }

  const Points& cloud_;
  const Sorted& sorted_;
  Method method_;
  Support support_;
  CellGrid grid_;
  Smoothed smoothed_;
  Spares<Worker> idle_;
  std::mutex mutex_;  // of what follows
  std::uint64_t neighbours_ = 0;
};

class Pss final : public Contender {
 public:
  Pss(MlsOperator op, WeightKind weight, Precision precision) : method_{op, weight, precision, 3} {}

  std::string name() const override {
    return fmt::format("pss {}, weight {}, {}", name_of(method_.op), name_of(method_.weight),
                       name_of(method_.precision));
  }
  bool peer() const override { return false; }

  Smoothed smooth(const Points& cloud, const Task& task) const override {
    Method method = method_;
    method.degree = task.degree;
    const Support support = support_of_radius(task.radius, method);
    const ThreadLimit limit(task.threads);
    const Timer timer;
    const Sorted sorted = sort_points(cloud.points);
    const Time sort = timer.elapsed();
    Smoothed smoothed = Pass(cloud, sorted, method, support).run();
    smoothed.time = timer.elapsed();
    smoothed.sort = sort;
    return smoothed;
  }

 private:
  Method method_;
};

}  // namespace

void add_pss(Contenders& contenders) {
  using enum MlsOperator;
  using enum WeightKind;
  using enum Precision;
  contenders.push_back(std::make_unique<Pss>(kFast, kPcl, kSingle));
  contenders.push_back(std::make_unique<Pss>(kFast, kGaussian, kSingle));
  contenders.push_back(std::make_unique<Pss>(kLevin, kGaussian, kSingle));
  contenders.push_back(std::make_unique<Pss>(kLevin, kGaussian, kDouble));
  contenders.push_back(std::make_unique<Pss>(kLevin, kWendland, kSingle));
  contenders.push_back(std::make_unique<Pss>(kLevin, kPcl, kSingle));
}

}  // namespace pss::bench
