// Reference planes across lanes: the weighted plane, and Newton's steps from there.
#if defined(PSS_CORE_SIMD_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_PLANE_INL_H_
#undef PSS_CORE_SIMD_PLANE_INL_H_
#else
#define PSS_CORE_SIMD_PLANE_INL_H_
#endif

#include "core/simd/eigen-inl.h"
#include "core/simd/weight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// The candidates of each lane's query in key order, relative to it, in units of its h.
///
/// Coordinate k of lane l is at [k * kLanes + l]; shorter lanes are padded with kFarAway.
template <class T>
struct Balls {
  const T* x;
  const T* y;
  const T* z;
  std::size_t steps;
};

/// Passes on which t may be pushed against its bound.
inline constexpr int kMostPushes = 4;

/// What decides that a lane goes on with the next precision, or with the safeguarded search.
template <class T>
struct Tolerance;

template <>
struct Tolerance<double> {
  static constexpr double kConverged = 1e-8;   // the error after such a step is its square
  static constexpr double kRounding = 1e-15;   // a residual that no step can improve
  static constexpr double kTie = 1e-10;        // eigenvalues closer, of the largest, are equal
  static constexpr double kFarthest = 0.5;     // bound of |t| and of the height
  static constexpr double kLeastPivot = 1e-6;  // of its diagonal element
  static constexpr int kMostPasses = 10;
  static constexpr bool kDecides = true;    // what is out of the domain
  static constexpr double kSettled = 1e-3;  // of `fast`
  static constexpr int kMostPlanePasses = 64;
};

template <>
struct Tolerance<float> {
  static constexpr float kConverged = 3e-4f;
  static constexpr float kRounding = 3e-7f;
  static constexpr float kTie = 1e-3f;
  static constexpr float kFarthest = 0.45f;
  static constexpr float kLeastPivot = 1e-2f;
  static constexpr int kMostPasses = 6;
  static constexpr bool kDecides = false;
  static constexpr float kSettled = 1e-3f;
  static constexpr int kMostPlanePasses = 6;
};

/// A plane a lane: the foot t n of the query, and whether the lane is still on the easy path;
/// whether it is so by having been found out of the domain.
template <class T>
struct Planes {
  Vec3<Vec<T>> n;
  Vec<T> t;
  Mask<T> easy;
  Mask<T> outside;
};

/// Sums about a place q, weights frozen there.
template <class V>
struct PlaneSums {
  V count, w;
  Vec3<V> p;
  Symmetric<V> pp;
};

template <class T, class W>
PlaneSums<Vec<T>> sum_about(const Balls<T>& balls, const W& weight, const Vec3<Vec<T>>& q) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V one = set(T{1});
  V count = zero, w = zero, sx = zero, sy = zero, sz = zero;
  V xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
  for (std::size_t k = 0; k < balls.steps * kLanes<T>; k += kLanes<T>) {
    const V x = load(balls.x + k) - q.x;
    const V y = load(balls.y + k) - q.y;
    const V z = load(balls.z + k) - q.z;
    const V wk = weight.weight(fma(x, x, fma(y, y, z * z)));
    const V wx = wk * x;
    const V wy = wk * y;
    const V wz = wk * z;
    count = count + hn::IfThenElseZero(wk > zero, one);
    w = w + wk;
    sx = sx + wx;
    sy = sy + wy;
    sz = sz + wz;
    xx = fma(wx, x, xx);
    xy = fma(wx, y, xy);
    xz = fma(wx, z, xz);
    yy = fma(wy, y, yy);
    yz = fma(wy, z, yz);
    zz = fma(wz, z, zz);
  }
  return {count, w, {sx, sy, sz}, {xx, xy, xz, yy, yz, zz}};
}

/// The weighted plane through the weighted centroid; a lane without one is not easy.
template <class T>
HWY_INLINE Planes<T> plane_of(const PlaneSums<Vec<T>>& s, const Vec3<Vec<T>>& q) {
  using V = Vec<T>;
  const auto enough = s.count >= set(T{3});
  const V per_w = set(T{1}) / hn::IfThenElse(enough, s.w, set(T{1}));
  const Vec3<V> c = per_w * s.p;
  const Symmetric<V> covariance{fnma(c.x, c.x, s.pp.xx * per_w), fnma(c.x, c.y, s.pp.xy * per_w),
                                fnma(c.x, c.z, s.pp.xz * per_w), fnma(c.y, c.y, s.pp.yy * per_w),
                                fnma(c.y, c.z, s.pp.yz * per_w), fnma(c.z, c.z, s.pp.zz * per_w)};
  const Eigen<V> eigen = eigen_decomposition(covariance);
  const V least = set(Tolerance<T>::kTie) * eigen.most;
  const auto plane = hn::And(hn::And(eigen.most > set(T(1e-24)), eigen.middle > least),
                             eigen.middle - eigen.least > least);
  const Vec3<V> n = normalized(eigen.least_vector);
  return {n, dot(n, q + c), hn::And(enough, plane), none<T>()};
}

template <class V>
HWY_INLINE V bounded(V t, V bound) {
  return hn::IfThenElse(t > bound, bound, hn::IfThenElse(t < hn::Neg(bound), hn::Neg(bound), t));
}

template <class T>
HWY_INLINE Planes<T> canonical(const Planes<T>& p) {
  const auto flip = hn::Not(is_canonical(p.n));
  return {negated_where(flip, p.n), hn::IfThenElse(flip, hn::Neg(p.t), p.t), p.easy, p.outside};
}

/// `fast`: the weighted plane about the foot point, until it no longer moves.
template <class T, class W>
Planes<T> settled_planes(const Balls<T>& balls, const W& weight, Mask<T> lanes) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V farthest = set(Tolerance<T>::kFarthest);
  const Vec3<V> query{zero, zero, zero};
  Planes<T> plane = plane_of<T>(sum_about<T>(balls, weight, query), query);
  plane.easy = hn::And(plane.easy, lanes);
  auto moving = plane.easy;
  for (int pass = 0; pass < Tolerance<T>::kMostPlanePasses && !hn::AllFalse(Tag<T>(), moving);
       ++pass) {
    plane.t = bounded(plane.t, set(T(0.5)));
    const Vec3<V> q = plane.t * plane.n;
    Planes<T> next = plane_of<T>(sum_about<T>(balls, weight, q), q);
    const auto flip = dot(next.n, plane.n) < zero;
    next.n = negated_where(flip, next.n);
    next.t = hn::IfThenElse(flip, hn::Neg(next.t), next.t);
    const V settled = set(Tolerance<T>::kSettled);
    const V slid = hn::Abs(bounded(next.t, set(T(0.5))) - plane.t);
    const V turned = hn::Max(hn::Max(hn::Abs(next.n.x - plane.n.x), hn::Abs(next.n.y - plane.n.y)),
                             hn::Abs(next.n.z - plane.n.z));
    plane.n = select(moving, next.n, plane.n);
    plane.t = hn::IfThenElse(moving, next.t, plane.t);
    plane.easy = hn::And(plane.easy, hn::Or(next.easy, hn::Not(moving)));
    moving = hn::And(hn::And(moving, plane.easy), hn::Max(turned, slid) > settled);
  }
  plane.easy = hn::And(plane.easy, hn::Not(moving));
  const auto inside = hn::Abs(plane.t) < farthest;
  if constexpr (Tolerance<T>::kDecides)
    plane.outside = hn::AndNot(inside, plane.easy);
  else
    plane.easy = hn::And(plane.easy, inside);
  plane.t = bounded(plane.t, set(T(0.5)));
  return canonical(plane);
}

/// Some steps of every lane seen from its foot point: in-plane coordinates, heights, weights.
template <class T>
struct Stage {
  static constexpr std::size_t kSteps = 32;
  static constexpr std::size_t kSize = kSteps * kLanes<T>;

  alignas(64) T x[kSize], y[kSize], d[kSize], w[kSize], first[kSize], second[kSize];
};

/// Fills the stage from `begin` on; `foot` is the foot point's coordinates in the axes.
template <bool kDerivatives, class T, class W>
HWY_INLINE void fill(const Balls<T>& balls, std::size_t begin, std::size_t count,
                     const Axes<Vec<T>>& a, const Vec3<Vec<T>>& foot, const W& weight,
                     Stage<T>& stage) {
  using V = Vec<T>;
  const T* const px = balls.x + begin * kLanes<T>;
  const T* const py = balls.y + begin * kLanes<T>;
  const T* const pz = balls.z + begin * kLanes<T>;
  const Axes<V> axes = a;
  const W weigh = weight;
  for (std::size_t k = 0; k < count * kLanes<T>; k += kLanes<T>) {
    const Vec3<V> p{load(px + k), load(py + k), load(pz + k)};
    const V x = dot(axes.u, p) - foot.x;
    const V y = dot(axes.v, p) - foot.y;
    const V d = dot(axes.n, p) - foot.z;
    const V rho_sq = fma(x, x, fma(y, y, d * d));
    store(x, stage.x + k);
    store(y, stage.y + k);
    store(d, stage.d + k);
    if constexpr (kDerivatives) {
      const Weighed<V> w = weigh.with_derivatives(rho_sq);
      store(w.weight, stage.w + k);
      store(w.first, stage.first + k);
      store(w.second, stage.second + k);
    } else {
      store(weigh.weight(rho_sq), stage.w + k);
    }
  }
}

/// Sums of a Newton pass about q = t n; the letters are those of PassSums.
template <class V>
struct NewtonSums {
  V w, wd, dd, cubic, curvature;
  V xx, xy, yy, xd, yd;
  V axx, axy, ayy;
  V g1x, g1y;  // (w + 2 d^2 w') {x, y}
  V g2x, g2y;  // (w + 3 d^2 w' - 2 t d (w' + d^2 w'')) {x, y}
};

template <class T>
HWY_INLINE void add(const Stage<T>& stage, std::size_t count, Vec<T> t, NewtonSums<Vec<T>>& sums) {
  using V = Vec<T>;
  NewtonSums<V> s = sums;
  const V two = set(T{2});
  const V minus_2t = hn::Neg(t + t);
  for (std::size_t k = 0; k < count * kLanes<T>; k += kLanes<T>) {
    const V x = load(stage.x + k);
    const V y = load(stage.y + k);
    const V d = load(stage.d + k);
    const V w = load(stage.w + k);
    const V w1 = load(stage.first + k);
    const V w2 = load(stage.second + k);
    const V wx = w * x;
    const V wy = w * y;
    const V d2 = d * d;
    const V a = w1 * d;
    const V ax = a * x;
    const V g = w1 * d2;          // d^2 w'
    const V h = d2 * w2;          // d^2 w''
    const V g1 = fma(two, g, w);  //
    const V g2 = fma(minus_2t, d * (w1 + h), g1 + g);
    s.w = s.w + w;
    s.wd = fma(w, d, s.wd);
    s.dd = fma(w, d2, s.dd);
    s.cubic = fma(a, d2, s.cubic);
    s.curvature = s.curvature + fma(set(T{5}), g, two * d2 * h);
    s.xx = fma(wx, x, s.xx);
    s.xy = fma(wx, y, s.xy);
    s.yy = fma(wy, y, s.yy);
    s.xd = fma(wx, d, s.xd);
    s.yd = fma(wy, d, s.yd);
    s.axx = fma(ax, x, s.axx);
    s.axy = fma(ax, y, s.axy);
    s.ayy = fma(a * y, y, s.ayy);
    s.g1x = fma(g1, x, s.g1x);
    s.g1y = fma(g1, y, s.g1y);
    s.g2x = fma(g2, x, s.g2x);
    s.g2y = fma(g2, y, s.g2y);
  }
  sums = s;
}

template <class T, class W>
NewtonSums<Vec<T>> newton_sums(const Balls<T>& balls, const W& weight, const Axes<Vec<T>>& axes,
                               Vec<T> t, Stage<T>& stage) {
  const auto zero = set(T{0});
  NewtonSums<Vec<T>> sums{zero, zero, zero, zero, zero, zero, zero, zero, zero,
                          zero, zero, zero, zero, zero, zero, zero, zero};
  for (std::size_t begin = 0; begin < balls.steps; begin += Stage<T>::kSteps) {
    const std::size_t count = HWY_MIN(Stage<T>::kSteps, balls.steps - begin);
    fill<true, T>(balls, begin, count, axes, {zero, zero, t}, weight, stage);
    add<T>(stage, count, t, sums);
  }
  return sums;
}

/// Newton's step, where the conditions are at a minimum of theirs; see PlaneConditions.
template <class V, class M>
struct NewtonStep {
  V a, b, t;
  V f2;  // the second condition: which way t is driven
  V residual_sq;
  M minimum;
};

template <class T>
HWY_INLINE NewtonStep<Vec<T>, Mask<T>> newton_step(const NewtonSums<Vec<T>>& s, Vec<T> t) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const auto some = s.w > zero;
  const V per_w = set(T{1}) / hn::IfThenElse(some, s.w, set(T{1}));
  const V f0 = s.xd * per_w;
  const V f1 = s.yd * per_w;
  const V f2 = (s.wd + s.cubic) * per_w;
  const V turn = fma(t, s.wd, s.dd);
  const V twice = t + t;
  const V j00 = (fnma(twice, s.axx, s.xx) - turn) * per_w;
  const V j01 = fnma(twice, s.axy, s.xy) * per_w;
  const V j11 = (fnma(twice, s.ayy, s.yy) - turn) * per_w;
  const V j02 = hn::Neg(s.g1x * per_w);
  const V j12 = hn::Neg(s.g1y * per_w);
  const V j20 = s.g2x * per_w;
  const V j21 = s.g2y * per_w;
  const V j22 = hn::Neg((s.w + s.curvature) * per_w);
  // The minimum: C_xy - C_dd I positive definite, convex along the normal.
  const V xx = s.xx - s.dd;
  const V yy = s.yy - s.dd;
  const V least = set(Tolerance<T>::kTie) * (s.xx + s.yy + s.dd);
  auto minimum = hn::And(some, xx > least);
  minimum = hn::And(minimum, fnma(s.xy, s.xy, xx * yy) > least * (xx + yy));
  minimum = hn::And(minimum, j22 < zero);
  // Elimination in the order a, b, t, whose pivots keep their signs near a minimum.
  const V one = set(T{1});
  const auto sound0 = j00 > zero;
  const V p0 = one / hn::IfThenElse(sound0, j00, one);
  const V l1 = j01 * p0;
  const V l2 = j20 * p0;
  const V k11 = fnma(l1, j01, j11);
  const V k12 = fnma(l1, j02, j12);
  const V r1 = fnma(l1, f0, f1);
  const V k21 = fnma(l2, j01, j21);
  const V k22 = fnma(l2, j02, j22);
  const V r2 = fnma(l2, f0, f2);
  const auto sound1 = k11 > zero;
  const V p1 = one / hn::IfThenElse(sound1, k11, one);
  const V l3 = k21 * p1;
  const V m22 = fnma(l3, k12, k22);
  const V r3 = fnma(l3, r1, r2);
  const auto sound2 = m22 < zero;
  minimum = hn::And(hn::And(minimum, sound0), hn::And(sound1, sound2));
  const V dt = hn::Neg(r3 / hn::IfThenElse(sound2, m22, one));
  const V db = fnma(k12, dt, hn::Neg(r1)) * p1;
  const V da = fnma(j02, dt, fnma(j01, db, hn::Neg(f0))) * p0;
  return {da, db, dt, f2, fma(f0, f0, fma(f1, f1, f2 * f2)), minimum};
}

/// The frame turned and t slid by a step, of at most 0.3 radians and then at most 0.25 in t.
template <class V, class M>
HWY_INLINE void move(const NewtonStep<V, M>& step, const Axes<V>& axes, V t, Vec3<V>& next_n,
                     V& next_t) {
  using T = hn::TFromV<V>;
  const V turn = hn::Sqrt(fma(step.a, step.a, step.b * step.b));
  const V slide = hn::Abs(step.t);
  V scale = hn::IfThenElse(turn > set(T(0.3)), set(T(0.3)) / turn, set(T(1)));
  scale = hn::IfThenElse(slide * scale > set(T(0.25)), set(T(0.25)) / slide, scale);
  next_n = normalized(axes.n + (step.a * scale) * axes.u + (step.b * scale) * axes.v);
  next_t = bounded(fma(step.t, scale, t), set(T(0.5)));
}

/// `levin`: Newton's method from the weighted plane about the query.
///
/// A lane stays easy while no safeguard is needed: the conditions at a minimum on every pass, a
/// residual that falls, few passes; in single precision also t away from its bound.
template <class T, class W>
Planes<T> newton_planes(const Balls<T>& balls, const W& weight, Mask<T> lanes, Stage<T>& stage) {
  using V = Vec<T>;
  using Tol = Tolerance<T>;
  const V zero = set(T{0});
  const V farthest = set(Tol::kFarthest);
  const Vec3<V> query{zero, zero, zero};
  Planes<T> plane = plane_of<T>(sum_about<T>(balls, weight, query), query);
  plane.t = bounded(plane.t, set(T(0.5)));
  plane.easy = hn::And(plane.easy, lanes);
  auto moving = plane.easy;
  V last = set(T(1e30));
  V pushes = zero;  // passes on which t stood at its bound and was pushed against it
  for (int pass = 0; pass < Tol::kMostPasses && !hn::AllFalse(Tag<T>(), moving); ++pass) {
    const Axes<V> axes = axes_of(plane.n);
    const auto step = newton_step<T>(newton_sums<T>(balls, weight, axes, plane.t, stage), plane.t);
    const auto pushed = hn::And(hn::Abs(plane.t) >= farthest, step.f2 * plane.t > zero);
    pushes = pushes + hn::IfThenElseZero(pushed, set(T(1)));
    const auto lost = hn::And(moving, pushes >= set(T(kMostPushes)));
    plane.outside = hn::Or(plane.outside, lost);
    moving = hn::AndNot(lost, moving);
    const auto good = hn::And(step.minimum, hn::Or(pushed, step.residual_sq <= last));
    last = step.residual_sq;
    Vec3<V> n;
    V t;
    move(step, axes, plane.t, n, t);
    const auto inside = hn::Abs(t) < farthest;
    const auto easy = Tol::kDecides ? good : hn::And(good, inside);
    plane.easy = hn::And(plane.easy, hn::Or(hn::Not(moving), easy));
    plane.n = select(moving, n, plane.n);
    plane.t = hn::IfThenElse(moving, t, plane.t);
    const V size = hn::Max(hn::Max(hn::Abs(step.a), hn::Abs(step.b)), hn::Abs(step.t));
    const auto done = hn::Or(size <= set(Tol::kConverged),
                             step.residual_sq <= set(Tol::kRounding * Tol::kRounding));
    moving = hn::AndNot(hn::And(done, inside), hn::And(moving, plane.easy));
  }
  plane.easy = hn::AndNot(moving, plane.easy);
  return canonical(plane);
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
