// The reference plane of `levin` with every safeguard, for the lanes that need one.
#if defined(PSS_CORE_SIMD_SEARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_SEARCH_INL_H_
#undef PSS_CORE_SIMD_SEARCH_INL_H_
#else
#define PSS_CORE_SIMD_SEARCH_INL_H_
#endif

#include "core/simd/newton-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Where a search stands, lane by lane; every decision depends on its lane's numbers alone.
template <class T>
class Search {
  using V = Vec<T>;
  using M = Mask<T>;

 public:
  Search(const Planes<T>& start, M lanes)
      : plane_(start),
        moving_(hn::And(lanes, hn::Eq(start.status, set(T{0})))),
        after_newton_(none<T>()),
        last_{start.n, start.t, {}} {
    const V zero = set(T{0});
    last_.step = {zero, zero, zero};
    last_residual_sq_ = pushes_ = halvings_ = alternations_ = zero;
    patience_ = set(T(kAlternations));
    plane_.easy = lanes;
  }

  bool going_on() const { return !hn::AllFalse(Tag<T>(), moving_); }
  const Vec3<V>& normal() const { return plane_.n; }
  V t() const { return plane_.t; }

  /// Decides on one pass's sums: moves on, or ends the search of a lane.
  void advance(const NewtonSums<V>& sums, const Axes<V>& axes) {
    const V zero = set(T{0});
    const auto step = newton_step<T>(sums, plane_.t);
    end(hn::Not(sums.w > zero), Status::kTooFew);
    const auto pushed = hn::And(hn::Abs(plane_.t) >= set(kBound), step.f2 * plane_.t > zero);
    pushes_ = pushes_ + hn::IfThenElseZero(pushed, set(T(1)));
    end(hn::And(pushed, pushes_ >= set(T(kMostPushes))), Status::kOutOfDomain);

    const auto grown = hn::AndNot(pushed, step.residual_sq > last_residual_sq_);
    const auto worse = hn::Or(hn::Not(step.minimum), grown);
    const auto halving = hn::And(moving_, hn::And(after_newton_, worse));
    const auto rest = hn::AndNot(halving, moving_);
    const auto stepping = hn::And(rest, hn::And(step.solvable, hn::Eq(alternations_, zero)));
    const auto turning = hn::AndNot(stepping, rest);

    Vec3<V> n = plane_.n;
    V t = plane_.t;
    if (!hn::AllFalse(Tag<T>(), turning)) alternate(turning, sums, step, axes, n, t);
    if (!hn::AllFalse(Tag<T>(), halving)) halve(halving, n, t);
    go(stepping, step, axes, n, t);
    plane_.n = select(moving_, n, plane_.n);
    plane_.t = hn::IfThenElse(moving_, t, plane_.t);

    const auto done = hn::And(converged(step), hn::Abs(plane_.t) < set(kBound));
    moving_ = hn::AndNot(hn::And(stepping, done), moving_);
  }

  Planes<T> result() {
    end(moving_, Status::kDegenerate);
    return canonical(plane_);
  }

 private:
  static constexpr T kBound = T(0.5);
  static constexpr int kMostHalvings = 3;
  static constexpr int kAlternations = 4;  // passes before Newton is tried again, at first

  void end(M lanes, Status status) {
    const auto ending = hn::And(lanes, moving_);
    plane_.status = hn::IfThenElse(ending, status_code<T>(status), plane_.status);
    moving_ = hn::AndNot(ending, moving_);
  }

  /// Newton's step, from which later ones may be halved.
  void go(M lanes, const NewtonStep<V, M>& step, const Axes<V>& axes, Vec3<V>& n, V& t) {
    const V zero = set(T{0});
    const Vec3<V> taken = shortened(step.step);
    last_.step = select(lanes, taken, last_.step);
    last_.n = select(lanes, plane_.n, last_.n);
    last_.t = hn::IfThenElse(lanes, plane_.t, last_.t);
    last_residual_sq_ = hn::IfThenElse(lanes, step.residual_sq, last_residual_sq_);
    halvings_ = hn::IfThenElse(lanes, zero, halvings_);
    after_newton_ = hn::Or(after_newton_, lanes);
    move(lanes, taken, axes, plane_.t, n, t);
  }

  /// Takes the last step back by half; after too many, gives Newton's method up for a while.
  void halve(M lanes, Vec3<V>& n, V& t) {
    const V zero = set(T{0});
    halvings_ = halvings_ + hn::IfThenElseZero(lanes, set(T(1)));
    const auto enough = hn::And(lanes, halvings_ > set(T(kMostHalvings)));
    alternations_ = hn::IfThenElse(enough, patience_, alternations_);
    patience_ = hn::IfThenElse(enough, patience_ + patience_, patience_);
    after_newton_ = hn::AndNot(enough, after_newton_);
    halvings_ = hn::IfThenElse(enough, zero, halvings_);
    last_.step = select(lanes, set(T(0.5)) * last_.step, last_.step);
    move(lanes, last_.step, axes_of(last_.n), last_.t, n, t);
  }

  /// The fallback: the normal from the covariance about q, then t along that normal, where the
  /// second condition is taken as linear in the turn.
  void alternate(M lanes, const NewtonSums<V>& s, const NewtonStep<V, M>& step, const Axes<V>& axes,
                 Vec3<V>& n, V& t) {
    const V zero = set(T{0});
    after_newton_ = hn::AndNot(lanes, after_newton_);
    halvings_ = hn::IfThenElse(lanes, zero, halvings_);
    const auto waiting = hn::And(lanes, alternations_ > zero);
    alternations_ = alternations_ - hn::IfThenElseZero(waiting, set(T(1)));
    const Eigen<V> eigen =
        eigen_decomposition(Symmetric<V>{s.xx * step.per_w, s.xy * step.per_w, s.xd * step.per_w,
                                         s.yy * step.per_w, s.yd * step.per_w, s.dd * step.per_w});
    const Vec3<V> e = negated_where(eigen.least_vector.z < zero, eigen.least_vector);
    const Vec3<V> turned = normalized(e.x * axes.u + e.y * axes.v + e.z * axes.n);
    const V force = fma(step.j21, e.y, fma(step.j20, e.x, step.f2));
    const auto convex = step.convexity > zero;
    const V slide =
        bounded(force / hn::IfThenElse(convex, step.convexity, set(T(1))), set(T(kMostSlide)));
    const V push = hn::CopySign(set(T(kMostSlide / 2)), step.f2);
    n = select(lanes, turned, n);
    t = hn::IfThenElse(lanes, bounded(plane_.t + hn::IfThenElse(convex, slide, push), set(kBound)),
                       t);
  }

  void move(M lanes, const Vec3<V>& step, const Axes<V>& axes, V from, Vec3<V>& n, V& t) const {
    n = select(lanes, turned(step, axes), n);
    t = hn::IfThenElse(lanes, bounded(from + step.z, set(kBound)), t);
  }

  struct Last {
    Vec3<V> n;
    V t;
    Vec3<V> step;
  };

  Planes<T> plane_;
  M moving_, after_newton_;
  Last last_;  // where the last step of Newton's began, and what is left of it
  V last_residual_sq_;
  V pushes_;        // passes on which t stood at its bound and was pushed against it
  V halvings_;      // of the last step
  V alternations_;  // to come before Newton's method is tried again
  V patience_;      // alternations after the next failure of Newton's method
};

template <class T, class W>
Planes<T> searched_planes(const Balls<T>& balls, const W& weight, Mask<T> lanes, Stage<T>& stage) {
  constexpr int kMostPasses = 64;
  Search<T> search(starting_planes<T>(balls, weight), lanes);
  for (int pass = 0; pass < kMostPasses && search.going_on(); ++pass) {
    const Axes<Vec<T>> axes = axes_of(search.normal());
    search.advance(newton_sums<T>(balls, weight, axes, search.t(), stage), axes);
  }
  return search.result();
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
