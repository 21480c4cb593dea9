// Newton's method for the reference plane across lanes.
#if defined(PSS_CORE_SIMD_NEWTON_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_NEWTON_INL_H_
#undef PSS_CORE_SIMD_NEWTON_INL_H_
#else
#define PSS_CORE_SIMD_NEWTON_INL_H_
#endif

#include "core/simd/stage-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// The most that one step may turn the plane, in radians, and slide it.
inline constexpr double kMostTurn = 0.3;
inline constexpr double kMostSlide = 0.25;

/// Sums of a Newton pass about q = t n: the conditions, their Jacobian, the covariance about q.
///
/// Per neighbour: in-plane coordinates x, y, height d, weight w and its derivatives w', w''.
template <class V>
struct NewtonSums {
  V w, wd, dd;         // w {1, d, d^2}
  V cubic, curvature;  // w' d^3, d^2 (5 w' + 2 d^2 w'')
  V xx, xy, yy;        // w {x^2, x y, y^2}
  V xd, yd;            // w d {x, y}
  V axx, axy, ayy;     // w' d {x^2, x y, y^2}
  V g1x, g1y;          // (w + 2 d^2 w') {x, y}
  V g2x, g2y;          // (w + 3 d^2 w' - 2 t d (w' + d^2 w'')) {x, y}
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

/// Newton's step towards the root of the conditions, where these are at a minimum of theirs.
template <class V, class M>
struct NewtonStep {
  Vec3<V> step;  // the turns a and b, and the slide t
  V residual_sq;
  V f2, j20, j21, convexity;  // the second condition, its derivatives by a, b and -t
  V per_w;
  M minimum;   // both conditions at a minimum
  M solvable;  // and the Jacobian not singular
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
  // Cramer's rule.
  const V c00 = fma(j11, j22, hn::Neg(j12 * j21));
  const V c01 = fma(j12, j20, hn::Neg(j01 * j22));
  const V c02 = fma(j01, j21, hn::Neg(j11 * j20));
  const V c10 = fma(j02, j21, hn::Neg(j01 * j22));
  const V c11 = fma(j00, j22, hn::Neg(j02 * j20));
  const V c12 = fma(j01, j20, hn::Neg(j00 * j21));
  const V c20 = fma(j01, j12, hn::Neg(j02 * j11));
  const V c21 = fma(j01, j02, hn::Neg(j00 * j12));
  const V c22 = fma(j00, j11, hn::Neg(j01 * j01));
  const V det = fma(j00, c00, fma(j01, c01, j02 * c02));
  const auto solvable = hn::And(minimum, hn::Abs(det) > set(T(1e-30)));
  const V per_det = set(T{-1}) / hn::IfThenElse(solvable, det, set(T{1}));
  const V da = fma(c00, f0, fma(c10, f1, c20 * f2)) * per_det;
  const V db = fma(c01, f0, fma(c11, f1, c21 * f2)) * per_det;
  const V dt = fma(c02, f0, fma(c12, f1, c22 * f2)) * per_det;
  return {
      {da, db, dt}, fma(f0, f0, fma(f1, f1, f2 * f2)), f2, j20, j21, hn::Neg(j22), per_w, minimum,
      solvable};
}

/// A step (a, b, t) of at most 0.3 radians, and then at most kMostSlide in t.
template <class V>
HWY_INLINE Vec3<V> shortened(const Vec3<V>& step) {
  using T = hn::TFromV<V>;
  constexpr T kTurn = T(kMostTurn), kSlide = T(kMostSlide);
  const V turn = hn::Sqrt(fma(step.x, step.x, step.y * step.y));
  const V slide = hn::Abs(step.z);
  V scale = hn::IfThenElse(turn > set(kTurn), set(kTurn) / turn, set(T(1)));
  scale = hn::IfThenElse(slide * scale > set(kSlide), set(kSlide) / slide, scale);
  return scale * step;
}

/// The normal after a step.
template <class V>
HWY_INLINE Vec3<V> turned(const Vec3<V>& step, const Axes<V>& axes) {
  return normalized(axes.n + step.x * axes.u + step.y * axes.v);
}

/// Whether the error after a step is of the order of rounding.
template <class V, class M>
HWY_INLINE auto converged(const NewtonStep<V, M>& step) {
  using Tol = Tolerance<hn::TFromV<V>>;
  const V size = hn::Max(hn::Max(hn::Abs(step.step.x), hn::Abs(step.step.y)), hn::Abs(step.step.z));
  return hn::Or(size <= set(Tol::kConverged),
                step.residual_sq <= set(Tol::kRounding * Tol::kRounding));
}

/// `levin` on the easy path: Newton's method from the weighted plane about the query.
///
/// A lane stays easy while no safeguard is needed: the conditions at a minimum on every pass, a
/// residual that falls, t away from its bound, few passes. It then does what the whole search
/// would do.
template <class T, class W>
Planes<T> newton_planes(const Balls<T>& balls, const W& weight, Mask<T> lanes, Stage<T>& stage) {
  using V = Vec<T>;
  using Tol = Tolerance<T>;
  const V farthest = set(Tol::kFarthest);
  Planes<T> plane = starting_planes<T>(balls, weight);
  auto moving =
      hn::And(hn::And(lanes, hn::Eq(plane.status, set(T{0}))), hn::Abs(plane.t) < farthest);
  plane.easy = moving;
  V last = set(T(1e30));
  for (int pass = 0; pass < Tol::kMostPasses && !hn::AllFalse(Tag<T>(), moving); ++pass) {
    const Axes<V> axes = axes_of(plane.n);
    const auto step = newton_step<T>(newton_sums<T>(balls, weight, axes, plane.t, stage), plane.t);
    auto good = hn::And(step.solvable, step.residual_sq <= last);
    last = step.residual_sq;
    const Vec3<V> taken = shortened(step.step);
    const V t = plane.t + taken.z;
    good = hn::And(good, hn::Abs(t) < farthest);
    plane.easy = hn::And(plane.easy, hn::Or(hn::Not(moving), good));
    plane.n = select(moving, turned(taken, axes), plane.n);
    plane.t = hn::IfThenElse(moving, t, plane.t);
    moving = hn::AndNot(converged(step), hn::And(moving, plane.easy));
  }
  plane.easy = hn::AndNot(moving, plane.easy);
  return canonical(plane);
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
