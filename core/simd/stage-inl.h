// Neighbours seen from a foot point: the first of the loops over them.
#if defined(PSS_CORE_SIMD_STAGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_STAGE_INL_H_
#undef PSS_CORE_SIMD_STAGE_INL_H_
#else
#define PSS_CORE_SIMD_STAGE_INL_H_
#endif

#include "core/simd/plane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

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

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
