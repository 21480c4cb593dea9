// Every kernel, compiled once for each target that fuses multiplication and addition, and once
// plainly with std::fma; the machine decides at run time which one is called.

#include "core/simd/project.h"

#include <cmath>

#include "core/simd/targets.h"
#include "core/weight.h"

// Without fused multiply-add a target would need other roundings than the rest.
#define HWY_DISABLED_TARGETS \
  (HWY_SSE4 | HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/project.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "core/simd/apss-inl.h"
#include "core/simd/candidates-inl.h"
#include "core/simd/filter-inl.h"
#include "core/simd/fit-inl.h"
#include "core/simd/lanes-inl.h"
#include "core/simd/plane-inl.h"
#include "core/simd/result-inl.h"
#include "core/simd/rimls-inl.h"
#include "core/simd/search-inl.h"
#include "core/simd/transpose-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Lanes on their way: filled one by one, computed together.
template <class T>
class Group {
  using V = Vec<T>;

 public:
  Group(const simd::Batch& batch, simd::Search search, simd::Workspace& workspace,
        std::vector<std::uint32_t>& rest)
      : batch_(batch), search_(search), w_(workspace), rest_(rest) {
    w_.stage.reserve(sizeof(Stage<T>));
  }

  simd::LaneRow<T>& next_row(std::uint32_t query) {
    rows()[lanes_].query = query;
    rows()[lanes_].count = 0;
    return rows()[lanes_++];
  }
  bool full() const { return lanes_ == kLanes<T>; }

  void compute() {
    if (lanes_ == 0) return;
    const Balls<T> balls = transposed();
    switch (batch_.method.weight) {
      case WeightKind::kGaussian:
        project<WeightKind::kGaussian>(balls);
        break;
      case WeightKind::kWendland:
        project<WeightKind::kWendland>(balls);
        break;
      case WeightKind::kPcl:
        project<WeightKind::kPcl>(balls);
        break;
    }
    lanes_ = 0;
  }

 private:
  simd::LaneRow<T>* rows() {
    if constexpr (sizeof(T) == 4)
      return w_.single;
    else
      return w_.twice;
  }

  static std::size_t whole(std::size_t steps) {
    return (steps + kLanes<T> - 1) / kLanes<T> * kLanes<T>;
  }

  /// The rows as columns, all as long as the longest, to whole vectors.
  Balls<T> transposed() {
    std::size_t most = 1;
    for (std::size_t l = 0; l < lanes_; ++l) most = std::max(most, rows()[l].count);
    const std::size_t steps = whole(most);
    w_.balls.reserve(3 * steps * kLanes<T> * sizeof(T));
    T* const x = reinterpret_cast<T*>(w_.balls.data());
    T* const y = x + steps * kLanes<T>;
    T* const z = y + steps * kLanes<T>;
    for (std::size_t l = lanes_; l < kLanes<T>; ++l) rows()[l].count = 0;
    transpose_rows(&simd::LaneRow<T>::x, T(kFarAway), steps, x);
    transpose_rows(&simd::LaneRow<T>::y, T(kFarAway), steps, y);
    transpose_rows(&simd::LaneRow<T>::z, T(kFarAway), steps, z);
    return {x, y, z, most};
  }

  /// The rows' normals as columns of `size` numbers in all, with room for the heights behind them.
  BallNormals<T> transposed_normals(std::size_t size) {
    const std::size_t steps = size / kLanes<T>;
    w_.normals.reserve(6 * size * sizeof(T));
    T* const x = reinterpret_cast<T*>(w_.normals.data());
    transpose_rows(&simd::LaneRow<T>::nx, T{0}, steps, x);
    transpose_rows(&simd::LaneRow<T>::ny, T{0}, steps, x + size);
    transpose_rows(&simd::LaneRow<T>::nz, T{0}, steps, x + 2 * size);
    return {x, x + size, x + 2 * size};
  }

  /// Shorter rows are filled up with `rest`.
  void transpose_rows(simd::Buffer<T> simd::LaneRow<T>::*axis, T rest, std::size_t steps, T* to) {
    const T* from[kLanes<T>];
    for (std::size_t l = 0; l < kLanes<T>; ++l)
      from[l] = padded(rows()[l].*axis, rows()[l].count, steps, rest);
    transpose<T>(from, steps, to);
  }

  /// R / h of each lane, cut to where the weights of a Gaussian vanish.
  V radii() {
    alignas(64) T radius[kLanes<T>];
    for (std::size_t l = 0; l < kLanes<T>; ++l) {
      const Support& support = batch_.support(rows()[l < lanes_ ? l : 0].query);
      radius[l] = static_cast<T>(std::min(support.radius / support.h, TaperedGaussian::kWidest));
    }
    return load(radius);
  }

  template <WeightKind kKind>
  void project(const Balls<T>& balls) {
    const V radius = radii();
    const WeightLanes<T, kKind> weight(radius);
    const auto lanes = hn::FirstN(Tag<T>(), lanes_);
    Stage<T>& stage = *reinterpret_cast<Stage<T>*>(w_.stage.data());
    if (needs_normals(batch_.method.op))
      return write(project_implicit(balls, weight, radius, lanes, stage));
    const Planes<T> plane = planes(balls, weight, lanes, stage);
    if (hn::AllFalse(Tag<T>(), plane.easy)) return refuse_all();
    const Axes<V> axes = axes_of(plane.n);
    const V zero = set(T{0});
    const Maps<T> map = fit<T>(batch_.method.degree, balls, weight, radius, axes,
                               Vec3<V>{zero, zero, plane.t}, stage);
    write(describe<T>(plane, axes, map));
  }

  template <class W>
  Planes<T> planes(const Balls<T>& balls, const W& weight, Mask<T> lanes, Stage<T>& stage) {
    if (batch_.method.op == MlsOperator::kFast) return settled_planes<T>(balls, weight, lanes);
    if constexpr (Tolerance<T>::kDecides)
      if (search_ == simd::Search::kWhole) return searched_planes<T>(balls, weight, lanes, stage);
    return newton_planes<T>(balls, weight, lanes, stage);
  }

  template <class W>
  Outcomes<T> project_implicit(const Balls<T>& balls, const W& weight, V radius, Mask<T> lanes,
                               Stage<T>& stage) {
    const MlsOperator op = batch_.method.op;
    const bool oriented = batch_.normals.oriented;
    const std::size_t size = whole(balls.steps) * kLanes<T>;
    const BallNormals<T> normals = transposed_normals(size);
    if (!oriented) lanes = hn::And(lanes, agree<T>(balls, normals, weight));
    const BallHeights<T> heights{normals.z + size, normals.z + 2 * size, normals.z + 3 * size};
    const Walk<T> walk = op == MlsOperator::kApss
                             ? walk_apss<T>(balls, normals, weight, lanes)
                             : walk_rimls<T>(balls, normals, weight, heights, lanes);
    return describe<T>(walk, op, oriented, balls, weight, radius, stage);
  }

  void write(const Outcomes<T>& outcomes) {
    for (std::size_t l = 0; l < lanes_; ++l) {
      const std::uint32_t query = rows()[l].query;
      if (!outcomes.write(l, batch_.support(query).h, batch_.method.degree, batch_.results[query]))
        rest_.push_back(query);
    }
  }

  void refuse_all() {
    for (std::size_t l = 0; l < lanes_; ++l) rest_.push_back(rows()[l].query);
  }

  const simd::Batch& batch_;
  simd::Search search_;
  simd::Workspace& w_;
  std::vector<std::uint32_t>& rest_;
  std::size_t lanes_ = 0;
};

/// Consecutive queries that share their candidates: a small box, not too many.
class Run {
 public:
  static constexpr std::size_t kMost = 512;
  static constexpr double kSpan = 6;  // the side of the box in reaches

  Run(const simd::Batch& batch, std::span<const std::uint32_t> which) : batch_(&batch) {
    for (const std::uint32_t i : which) {
      if (count_ == kMost || !add(i)) break;
      ++count_;
    }
  }

  std::size_t count() const { return count_; }
  const IndexBox& box() const { return box_; }
  double reach() const { return reach_ + rest_; }
  bool exact() const { return rest_ == 0; }

 private:
  bool add(std::uint32_t i) {
    const Query& query = batch_->queries[i];
    const double wanted = pss::reach(batch_->method.weight, batch_->support(i));
    const double span = kSpan * (count_ > 0 ? std::min(reach_, wanted) : wanted);
    IndexBox box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.min[a] = std::min(box_.min[a], query.position[a]);
      box.max[a] = std::max(box_.max[a], query.position[a]);
      if (static_cast<double>(box.max[a] - box.min[a]) * batch_->grid.lattice().scale[a] > span)
        return false;
    }
    box_ = box;
    reach_ = std::max(reach_, wanted);
    const World3& r = query.remainder;
    const double rest_sq = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    if (rest_sq > 0) rest_ = std::max(rest_, std::sqrt(rest_sq));
    return true;
  }

  const simd::Batch* batch_;
  IndexBox box_;
  double reach_ = 0;
  double rest_ = 0;  // the largest remainder
  std::size_t count_ = 0;
};

/// The longest run from the front whose candidates are one slice, or one query; finds them.
Run run_of(const simd::Batch& batch, std::span<const std::uint32_t> which, Candidates& candidates) {
  Run run(batch, which);
  while (candidates.find(run.box(), run.reach(), run.exact()) > simd::kMostCandidates &&
         run.count() > 1)
    run = Run(batch, which.first(run.count() / 2));
  return run;
}

template <class T, bool kNormals>
void project_in(const simd::Batch& batch, simd::Search search, std::span<const std::uint32_t> which,
                simd::Workspace& workspace, std::vector<std::uint32_t>& rest) {
  Group<T> group(batch, search, workspace, rest);
  Candidates candidates(batch, workspace);
  while (!which.empty()) {
    const Run run = run_of(batch, which, candidates);
    const bool whole = candidates.load();
    const auto filter = [&](const Seeker& seeker, simd::LaneRow<T>& row) {
      Filter<kNormals>(candidates).add(seeker, row);
    };
    for (const std::uint32_t i : which.first(run.count())) {
      const Support& support = batch.support(i);
      const Seeker seeker(batch.queries[i], support.h, pss::reach(batch.method.weight, support),
                          candidates);
      simd::LaneRow<T>& row = group.next_row(i);
      if (whole) filter(seeker, row);
      // More than one slice only where the run is this query alone.
      while (run.count() == 1 && candidates.load()) filter(seeker, row);
      if (group.full()) group.compute();
    }
    which = which.subspan(run.count());
  }
  group.compute();
}

template <class T>
void project_in(const simd::Batch& batch, simd::Search search, std::span<const std::uint32_t> which,
                simd::Workspace& workspace, std::vector<std::uint32_t>& rest) {
  needs_normals(batch.method.op) ? project_in<T, true>(batch, search, which, workspace, rest)
                                 : project_in<T, false>(batch, search, which, workspace, rest);
}

void project(const simd::Batch& batch, Precision precision, simd::Search search,
             std::span<const std::uint32_t> which, simd::Workspace& workspace,
             std::vector<std::uint32_t>& rest) {
  precision == Precision::kSingle ? project_in<float>(batch, search, which, workspace, rest)
                                  : project_in<double>(batch, search, which, workspace, rest);
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pss {

HWY_EXPORT(project);

namespace simd {

void project(const Batch& batch, Precision precision, Search search,
             std::span<const std::uint32_t> which, Workspace& workspace,
             std::vector<std::uint32_t>& rest) {
  HWY_DYNAMIC_DISPATCH(pss::project)(batch, precision, search, which, workspace, rest);
}

std::vector<Target> targets() {
  std::vector<Target> found;
  for (const std::int64_t bit : hwy::SupportedAndGeneratedTargets())
    found.push_back({hwy::TargetName(bit), bit});
  return found;
}

ForcedTarget::ForcedTarget(const Target& target) {
  hwy::SetSupportedTargetsForTest(target.bit);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

ForcedTarget::~ForcedTarget() {
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace simd
}  // namespace pss
#endif
