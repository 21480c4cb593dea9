// Weighted planes across lanes: where every search begins, and where `fast` ends.
#if defined(PSS_CORE_SIMD_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_PLANE_INL_H_
#undef PSS_CORE_SIMD_PLANE_INL_H_
#else
#define PSS_CORE_SIMD_PLANE_INL_H_
#endif

#include "core/simd/eigen-inl.h"
#include "core/simd/weight-inl.h"
#include "core/status.h"

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
  static constexpr bool kDecides = true;    // whether a lane's status can be told
  static constexpr double kSettled = 1e-3;  // of `fast`
  static constexpr int kMostPlanePasses = 64;
};

template <>
struct Tolerance<float> {
  static constexpr float kConverged = 3e-4f;
  static constexpr float kRounding = 3e-7f;
  static constexpr float kTie = 1e-3f;
  static constexpr float kFarthest = 0.45f;
  static constexpr float kLeastPivot = 3e-2f;
  static constexpr int kMostPasses = 6;
  static constexpr bool kDecides = false;
  static constexpr float kSettled = 1e-3f;
  static constexpr int kMostPlanePasses = 6;
};

/// The plane of each lane, with the foot t n of the query.
template <class T>
struct Planes {
  Vec3<Vec<T>> n;
  Vec<T> t;
  Vec<T> status;  // 0, or the Status of a lane without a plane
  Mask<T> easy;   // lanes whose plane or status is certain; others ask for another computation
};

template <class T>
HWY_INLINE Vec<T> status_code(Status status) {
  return set(static_cast<T>(static_cast<int>(status)));
}

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

template <class V>
HWY_INLINE V bounded(V t, V bound) {
  return hn::IfThenElse(t > bound, bound, hn::IfThenElse(t < hn::Neg(bound), hn::Neg(bound), t));
}

/// The weighted plane through the weighted centroid; some plane where there is none.
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
  const V status =
      hn::IfThenElse(enough, hn::IfThenElse(plane, set(T{0}), status_code<T>(Status::kDegenerate)),
                     status_code<T>(Status::kTooFew));
  const V t = hn::IfThenElseZero(hn::Eq(status, set(T{0})), dot(n, q + c));
  return {n, bounded(t, set(T(0.5))), status, none<T>()};
}

/// Where every search begins: weights about the query itself.
template <class T, class W>
HWY_INLINE Planes<T> starting_planes(const Balls<T>& balls, const W& weight) {
  const Vec<T> zero = set(T{0});
  const Vec3<Vec<T>> query{zero, zero, zero};
  return plane_of<T>(sum_about<T>(balls, weight, query), query);
}

template <class T>
HWY_INLINE Planes<T> canonical(const Planes<T>& p) {
  const auto flip = hn::Not(is_canonical(p.n));
  return {negated_where(flip, p.n), hn::IfThenElse(flip, hn::Neg(p.t), p.t), p.status, p.easy};
}

/// `fast`: the weighted plane about the foot point, until it no longer moves.
template <class T, class W>
Planes<T> settled_planes(const Balls<T>& balls, const W& weight, Mask<T> lanes) {
  using V = Vec<T>;
  using Tol = Tolerance<T>;
  const V zero = set(T{0});
  Planes<T> plane = starting_planes<T>(balls, weight);
  auto moving = hn::And(lanes, hn::Eq(plane.status, zero));
  for (int pass = 0; pass < Tol::kMostPlanePasses && !hn::AllFalse(Tag<T>(), moving); ++pass) {
    const Vec3<V> q = plane.t * plane.n;
    Planes<T> next = plane_of<T>(sum_about<T>(balls, weight, q), q);
    const auto flip = dot(next.n, plane.n) < zero;
    next.n = negated_where(flip, next.n);
    next.t = hn::IfThenElse(flip, hn::Neg(next.t), next.t);
    const V slid = hn::Abs(next.t - plane.t);
    const V turned = hn::Max(hn::Max(hn::Abs(next.n.x - plane.n.x), hn::Abs(next.n.y - plane.n.y)),
                             hn::Abs(next.n.z - plane.n.z));
    plane.n = select(moving, next.n, plane.n);
    plane.t = hn::IfThenElse(moving, next.t, plane.t);
    plane.status = hn::IfThenElse(moving, next.status, plane.status);
    moving = hn::And(hn::And(moving, hn::Eq(plane.status, zero)),
                     hn::Max(turned, slid) > set(Tol::kSettled));
  }
  const auto inside = hn::Abs(plane.t) < set(Tol::kFarthest);
  if constexpr (Tol::kDecides) {
    plane.easy = lanes;
    const V end = hn::IfThenElse(inside, zero, status_code<T>(Status::kOutOfDomain));
    plane.status = hn::IfThenElse(hn::Eq(plane.status, zero), end, plane.status);
    plane.status = hn::IfThenElse(moving, status_code<T>(Status::kDegenerate), plane.status);
  } else {
    plane.easy = hn::And(hn::And(lanes, hn::Eq(plane.status, zero)), hn::AndNot(moving, inside));
  }
  return canonical(plane);
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
