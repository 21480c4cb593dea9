// Algebraic point set surfaces across lanes: the sphere that fits points and normals.
#if defined(PSS_CORE_SIMD_APSS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_APSS_INL_H_
#undef PSS_CORE_SIMD_APSS_INL_H_
#else
#define PSS_CORE_SIMD_APSS_INL_H_
#endif

#include "core/simd/implicit-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Sums of points, normals and their products about a place.
template <class V>
struct SphereSums {
  V count, w;
  Vec3<V> p, n;
  V pn, pp;
};

template <class T, class W>
HWY_NOINLINE SphereSums<Vec<T>> sum_sphere(const Balls<T>& balls, const BallNormals<T>& normals,
                                           const W& weight, const Vec3<Vec<T>>& x) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V one = set(T{1});
  const Vec3<V> at = x;
  const W weigh = weight;
  V count = zero, w = zero, pn = zero, pp = zero;
  Vec3<V> sum_p{zero, zero, zero}, sum_n{zero, zero, zero};
  for (std::size_t k = 0; k < balls.steps * kLanes<T>; k += kLanes<T>) {
    const Vec3<V> p{load(balls.x + k) - at.x, load(balls.y + k) - at.y, load(balls.z + k) - at.z};
    const Vec3<V> n = normals[k];
    const V rho_sq = dot(p, p);
    const V wk = hn::IfThenElseZero(has_direction(n), weigh.weight(rho_sq));
    count = count + hn::IfThenElseZero(wk > zero, one);
    w = w + wk;
    sum_p = fma(wk, p, sum_p);
    sum_n = fma(wk, n, sum_n);
    pn = fma(wk, dot(p, n), pn);
    pp = fma(wk, rho_sq, pp);
  }
  return {count, w, sum_p, sum_n, pn, pp};
}

/// The step from the place of the sums to their sphere, f = uc + ul.x + uq |x|^2.
///
/// Source: Guennebaud, Gross, "Algebraic Point Set Surfaces", SIGGRAPH 2007, section 4.
template <class T>
HWY_INLINE ImplicitStep<T> sphere_step(const SphereSums<Vec<T>>& s) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V one = set(T{1});
  const V per_w = one / hn::IfThenElse(s.w > zero, s.w, one);
  const V spread = fnma(dot(s.p, s.p), per_w, s.pp);
  // Where all points are one, a plane: 4 roundings a point.
  constexpr T kEpsilon = sizeof(T) == 4 ? T(0x1p-23) : T(0x1p-52);
  const auto curved = spread > set(T(4) * kEpsilon) * s.count * s.pp;
  const V turning = fnma(dot(s.p, s.n), per_w, s.pn);
  const V twice_uq = hn::IfThenElseZero(curved, turning / hn::IfThenElse(curved, spread, one));
  const V uq = set(T(0.5)) * twice_uq;
  const Vec3<V> ul{per_w * fnma(twice_uq, s.p.x, s.n.x), per_w * fnma(twice_uq, s.p.y, s.n.y),
                   per_w * fnma(twice_uq, s.p.z, s.n.z)};
  const V uc = hn::Neg(per_w * fma(uq, s.pp, dot(ul, s.p)));
  const V slope_sq = dot(ul, ul);
  const V slope = hn::Sqrt(slope_sq);
  const V discriminant = fnma(set(T{4}) * uc, uq, slope_sq);
  const auto exists = hn::And(slope > set(WalkLimits<T>::kRounding) * s.count, discriminant > zero);
  const V root = hn::Sqrt(hn::IfThenElse(exists, discriminant, one));
  const V per_slope = one / hn::IfThenElse(exists, slope, one);
  const auto wide = spread > set(T(1e-2)) * hn::Max(s.pp, s.w);
  const auto steep = hn::And(slope > set(T(0.1)), discriminant > set(T(0.1)) * slope_sq);
  return {s.count, per_slope * ul,      hn::Neg(uc + uc) / (slope + root), hn::Neg(twice_uq) / root,
          exists,  hn::And(wide, steep)};
}

/// `apss`: steps to the sphere of each place.
template <class T, class W>
Walk<T> walk_apss(const Balls<T>& balls, const BallNormals<T>& normals, const W& weight,
                  Mask<T> lanes) {
  return walk<T>(lanes, [&](const Vec3<Vec<T>>& x) {
    return sphere_step<T>(sum_sphere<T>(balls, normals, weight, x));
  });
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
