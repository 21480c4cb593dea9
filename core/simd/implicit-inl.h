// What apss and rimls share across lanes: normals that agree, steps along a gradient, outcomes.
#if defined(PSS_CORE_SIMD_IMPLICIT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_IMPLICIT_INL_H_
#undef PSS_CORE_SIMD_IMPLICIT_INL_H_
#else
#define PSS_CORE_SIMD_IMPLICIT_INL_H_
#endif

#include "core/simd/result-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// The normals of the points of Balls, laid out as they are; zero where there is none.
template <class T>
struct BallNormals {
  T* x;
  T* y;
  T* z;

  HWY_INLINE Vec3<Vec<T>> operator[](std::size_t k) const {
    return {load(x + k), load(y + k), load(z + k)};
  }
};

/// Points without a normal have no weight.
template <class V>
HWY_INLINE auto has_direction(const Vec3<V>& n) {
  return hn::Ne(hn::Or(hn::Or(n.x, n.y), n.z), hn::Zero(hn::DFromV<V>()));
}

/// When a walk ends; in single precision a lane near a limit goes on in double.
template <class T>
struct WalkLimits;

template <>
struct WalkLimits<double> {
  static constexpr double kShortest = 1e-6;  // a step that ends the walk
  static constexpr double kFarthest = 0.5;
  static constexpr double kFewest = 3;  // points with a weight
  static constexpr int kMostSteps = 32;
  static constexpr double kRounding = 0x1p-50;  // of a sum of units, each
};

template <>
struct WalkLimits<float> {
  static constexpr float kShortest = 1e-5f;
  static constexpr float kFarthest = 0.45f;
  static constexpr float kFewest = 6;
  static constexpr int kMostSteps = 8;
  static constexpr float kRounding = 0x1p-21f;
};

/// A move of `length` along the unit vector `normal`, towards the surface that a place sees.
template <class T>
struct ImplicitStep {
  using V = Vec<T>;

  V count;  // points with a weight
  Vec3<V> normal;
  V length;
  V mean_curvature;  // zero where the operator leaves it to the fit
  Mask<T> exists;
  Mask<T> sound;  // far enough from what decides for single precision
};

/// Where walks ended, and how: a Status as a number, 0 for those that arrived.
template <class T>
struct Walk {
  using V = Vec<T>;

  Vec3<V> place;
  Vec3<V> normal;
  V mean_curvature;
  V status;
  Mask<T> easy;
};

/// What a step means for a lane; comparisons that a NaN fails end its walk.
template <class T>
HWY_INLINE Vec<T> judge(const ImplicitStep<T>& step, Vec<T> distance_sq) {
  const auto enough = step.count >= set(T{3});
  const auto inside = distance_sq < set(T(0.25));
  const auto moved =
      hn::IfThenElse(inside, status_code<T>(Status::kOk), status_code<T>(Status::kOutOfDomain));
  const auto stepped = hn::IfThenElse(step.exists, moved, status_code<T>(Status::kDegenerate));
  return hn::IfThenElse(enough, stepped, status_code<T>(Status::kTooFew));
}

/// Follows step_at from the query until a step is short; a lane that fails stays where it failed.
template <class T, class StepAt>
HWY_INLINE Walk<T> walk(Mask<T> lanes, const StepAt& step_at) {
  using V = Vec<T>;
  using Limits = WalkLimits<T>;
  const V zero = set(T{0});
  const V farthest_sq = set(Limits::kFarthest * Limits::kFarthest);
  Walk<T> w{{zero, zero, zero}, {zero, zero, set(T{1})}, zero, zero, lanes};
  auto moving = lanes;
  for (int i = 0; i < Limits::kMostSteps && !hn::AllFalse(Tag<T>(), moving); ++i) {
    const ImplicitStep<T> step = step_at(w.place);
    const Vec3<V> next = w.place + step.length * step.normal;
    const V distance_sq = dot(next, next);
    w.status = hn::IfThenElse(moving, judge<T>(step, distance_sq), w.status);
    const auto sure =
        hn::And(step.sound, hn::And(step.count >= set(Limits::kFewest), distance_sq < farthest_sq));
    w.easy = hn::And(w.easy, hn::Or(sure, hn::Not(moving)));
    const auto good = hn::And(moving, hn::Eq(w.status, zero));
    w.place = select(good, next, w.place);
    w.normal = select(good, step.normal, w.normal);
    w.mean_curvature = hn::IfThenElse(good, step.mean_curvature, w.mean_curvature);
    moving = hn::And(good, hn::Abs(step.length) > set(Limits::kShortest));
    if constexpr (sizeof(T) == 4) moving = hn::And(moving, w.easy);
  }
  w.easy = hn::And(w.easy, hn::Not(moving));
  w.status = hn::IfThenElse(moving, status_code<T>(Status::kDegenerate), w.status);
  // Double precision decides everything itself.
  if constexpr (sizeof(T) == 8) w.easy = lanes;
  return w;
}

/// Turns normals of unknown side, in place, to agree with the main direction of those about the
/// query; gives the lanes whose turns are beyond the doubts of rounding.
template <class T, class W>
HWY_NOINLINE Mask<T> agree(const Balls<T>& balls, const BallNormals<T>& normals, const W& weight) {
  using V = Vec<T>;
  const V zero = set(T{0});
  Symmetric<V> m{zero, zero, zero, zero, zero, zero};
  for (std::size_t k = 0; k < balls.steps * kLanes<T>; k += kLanes<T>) {
    const Vec3<V> p{load(balls.x + k), load(balls.y + k), load(balls.z + k)};
    const Vec3<V> n = normals[k];
    const Vec3<V> wn = weight.weight(dot(p, p)) * n;
    m.xx = fma(wn.x, n.x, m.xx);
    m.xy = fma(wn.x, n.y, m.xy);
    m.xz = fma(wn.x, n.z, m.xz);
    m.yy = fma(wn.y, n.y, m.yy);
    m.yz = fma(wn.y, n.z, m.yz);
    m.zz = fma(wn.z, n.z, m.zz);
  }
  const Eigen<V> eigen = eigen_decomposition(m);
  const auto flip = hn::Not(is_canonical(eigen.most_vector));
  const Vec3<V> main = negated_where(flip, eigen.most_vector);
  // In double precision every turn counts as sure.
  constexpr bool kDoubts = sizeof(T) == 4;
  auto sure = hn::Eq(zero, zero);
  if constexpr (kDoubts) sure = eigen.most - eigen.middle > set(T(1e-2)) * eigen.most;
  for (std::size_t k = 0; k < balls.steps * kLanes<T>; k += kLanes<T>) {
    const Vec3<V> n = normals[k];
    const V along = dot(n, main);
    const Vec3<V> turned = negated_where(along < zero, n);
    store(turned.x, normals.x + k);
    store(turned.y, normals.y + k);
    store(turned.z, normals.z + k);
    const auto across = hn::And(hn::Abs(along) < set(T(1e-4)), has_direction(n));
    if constexpr (kDoubts) sure = hn::And(sure, hn::Not(across));
  }
  return sure;
}

/// The outcome of walks: the fit about each place describes its neighbourhood.
template <class T, class W>
HWY_INLINE Outcomes<T> describe(const Walk<T>& walk, MlsOperator op, bool oriented,
                                const Balls<T>& balls, const W& weight, Vec<T> radius,
                                Stage<T>& stage) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const auto never = hn::Ne(zero, zero);
  const auto flip = oriented ? never : hn::Not(is_canonical(walk.normal));
  const Axes<V> axes = axes_of(negated_where(flip, walk.normal));
  const Vec3<V> foot{dot(axes.u, walk.place), dot(axes.v, walk.place), dot(axes.n, walk.place)};
  const Maps<T> map = fit<2, T>(balls, weight, radius, axes, foot, stage);
  Outcomes<T> o;
  keep_fit<T>(map, o);
  keep(o, Outcomes<T>::kMove, walk.place);
  keep(o, Outcomes<T>::kNormal, axes.n);
  if (op == MlsOperator::kRimls) {
    keep_curvatures<T>(map, axes, true, never, o);
  } else {
    const V mean = walk.mean_curvature;
    store(hn::IfThenElse(flip, hn::Neg(mean), mean), o.value[Outcomes<T>::kMean]);
    store(mean * mean, o.value[Outcomes<T>::kGaussian]);
    keep(o, Outcomes<T>::kDirection, Vec3<V>{zero, zero, zero});
  }
  // There is no degree that the neighbourhood could fall short of.
  store(set(T(kMostDegree)), o.value[Outcomes<T>::kDegree]);
  store(walk.status, o.value[Outcomes<T>::kStatus]);
  auto easy = walk.easy;
  if constexpr (sizeof(T) == 4) easy = hn::And(easy, map.sound);
  store(hn::IfThenElseZero(easy, set(T{1})), o.value[Outcomes<T>::kEasy]);
  o.judge();
  return o;
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
