// Robust implicit moving least squares across lanes: outliers lose weight, refit after refit.
#if defined(PSS_CORE_SIMD_RIMLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_RIMLS_INL_H_
#undef PSS_CORE_SIMD_RIMLS_INL_H_
#else
#define PSS_CORE_SIMD_RIMLS_INL_H_
#endif

#include "core/simd/implicit-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// What the points of Balls are to a place, laid out as they are and kept between refits.
template <class T>
struct BallHeights {
  T* height;  // of the place over the point's tangent plane
  T* weight;
  T* slope;  // twice the derivative of the weight with respect to rho^2
};

/// The implicit function and its gradient, and how much weight they rest on.
template <class T>
struct Implicit {
  Vec<T> f;
  Vec3<Vec<T>> gradient;
  Vec<T> w;
};

/// Sums over points: weights, heights, normals, gradients of the weights.
template <class V>
struct HeightSums {
  V w, f;
  Vec3<V> n;   // w n
  Vec3<V> g;   // grad w
  Vec3<V> fg;  // f grad w

  /// Adds a point that lies at x - `to`.
  HWY_INLINE void add(V weight, V slope, V height, const Vec3<V>& normal, const Vec3<V>& to) {
    w = w + weight;
    f = fma(weight, height, f);
    n = fma(weight, normal, n);
    g = fma(slope, to, g);
    fg = fma(slope * height, to, fg);
  }

  template <class T>
  HWY_INLINE Implicit<T> solve() const {
    const V one = set(T{1});
    const V per_w = one / hn::IfThenElse(w > set(T{0}), w, one);
    const V value = f * per_w;
    return {value,
            {per_w * (fnma(value, g.x, fg.x) + n.x), per_w * (fnma(value, g.y, fg.y) + n.y),
             per_w * (fnma(value, g.z, fg.z) + n.z)},
            w};
  }
};

template <class T>
HWY_INLINE HeightSums<Vec<T>> no_heights() {
  const auto zero = set(T{0});
  const Vec3<Vec<T>> nowhere{zero, zero, zero};
  return {zero, zero, nowhere, nowhere, nowhere};
}

/// The first fit about a place, every point with its weight; counts those that have one.
template <class T, class W>
HWY_NOINLINE Implicit<T> first_fit(const Balls<T>& balls, const BallNormals<T>& normals,
                                   const W& weight, const Vec3<Vec<T>>& x,
                                   const BallHeights<T>& kept, Vec<T>& count) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V one = set(T{1});
  const Vec3<V> at = x;
  const W weigh = weight;
  HeightSums<V> sums = no_heights<T>();
  V counted = zero;
  for (std::size_t k = 0; k < balls.steps * kLanes<T>; k += kLanes<T>) {
    const Vec3<V> to{at.x - load(balls.x + k), at.y - load(balls.y + k), at.z - load(balls.z + k)};
    const Vec3<V> n = normals[k];
    const Weighed<V> weighed = weigh.with_derivatives(dot(to, to));
    const auto counts = has_direction(n);
    const V w = hn::IfThenElseZero(counts, weighed.weight);
    const V slope = hn::IfThenElseZero(counts, weighed.first + weighed.first);
    const V height = dot(n, to);
    store(height, kept.height + k);
    store(w, kept.weight + k);
    store(slope, kept.slope + k);
    counted = counted + hn::IfThenElseZero(w > zero, one);
    sums.add(w, slope, height, n, to);
  }
  count = counted;
  return sums.template solve<T>();
}

/// The fit again, points weighing less whose height or normal differs from what `last` says.
template <class T>
HWY_NOINLINE Implicit<T> refit(const Balls<T>& balls, const BallNormals<T>& normals,
                               const BallHeights<T>& kept, const Vec3<Vec<T>>& x,
                               const Implicit<T>& last) {
  using V = Vec<T>;
  constexpr double kLog2E = 1.44269504088896341;
  constexpr double kSigmaHeight = 0.5;
  constexpr double kSigmaNormal = 0.75;
  const V off = set(T(-kLog2E / (kSigmaHeight * kSigmaHeight)));
  const V turned = set(T(-kLog2E / (kSigmaNormal * kSigmaNormal)));
  const Vec3<V> at = x;
  const Implicit<T> old = last;
  HeightSums<V> sums = no_heights<T>();
  for (std::size_t k = 0; k < balls.steps * kLanes<T>; k += kLanes<T>) {
    const Vec3<V> to{at.x - load(balls.x + k), at.y - load(balls.y + k), at.z - load(balls.z + k)};
    const Vec3<V> n = normals[k];
    const V height = load(kept.height + k);
    const V apart = height - old.f;
    const Vec3<V> turn{n.x - old.gradient.x, n.y - old.gradient.y, n.z - old.gradient.z};
    const V a = exp2<T>(fma(off * apart, apart, turned * dot(turn, turn)));
    sums.add(a * load(kept.weight + k), a * load(kept.slope + k), height, n, to);
  }
  return sums.template solve<T>();
}

/// Source: Oztireli, Guennebaud, Gross, "Feature Preserving Point Set Surfaces based on
///         Non-Linear Kernel Regression", Eurographics 2009.
template <class T, class W>
HWY_INLINE ImplicitStep<T> robust_step(const Balls<T>& balls, const BallNormals<T>& normals,
                                       const W& weight, const BallHeights<T>& kept,
                                       const Vec3<Vec<T>>& x) {
  using V = Vec<T>;
  constexpr int kRefits = 3;
  const V zero = set(T{0});
  const V one = set(T{1});
  V count;
  Implicit<T> fit = first_fit<T>(balls, normals, weight, x, kept, count);
  const V all = fit.w;
  auto exists = fit.w > zero;
  for (int i = 0; i < kRefits; ++i) {
    fit = refit<T>(balls, normals, kept, x, fit);
    exists = hn::And(exists, fit.w > zero);
  }
  const V slope = hn::Sqrt(dot(fit.gradient, fit.gradient));
  exists = hn::And(exists, slope > set(WalkLimits<T>::kRounding) * count);
  const V per_slope = one / hn::IfThenElse(exists, slope, one);
  const auto sound = hn::And(fit.w > set(T(1e-3)) * all, slope > set(T(0.1)));
  return {count, per_slope * fit.gradient, hn::Neg(fit.f), zero, exists, sound};
}

/// `rimls`: steps along the gradient, refitted at each place.
template <class T, class W>
Walk<T> walk_rimls(const Balls<T>& balls, const BallNormals<T>& normals, const W& weight,
                   const BallHeights<T>& kept, Mask<T> lanes) {
  return walk<T>(lanes, [&](const Vec3<Vec<T>>& x) {
    return robust_step<T>(balls, normals, weight, kept, x);
  });
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
