// Weights of neighbours across lanes, with their derivatives; lengths in units of each lane's h.
#if defined(PSS_CORE_SIMD_WEIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_WEIGHT_INL_H_
#undef PSS_CORE_SIMD_WEIGHT_INL_H_
#else
#define PSS_CORE_SIMD_WEIGHT_INL_H_
#endif

#include "core/method.h"
#include "core/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// What a lane's padding is filled with: beyond every radius, so that its weight is zero.
inline constexpr double kFarAway = 40;

/// The weight, and its derivatives with respect to rho^2.
template <class V>
struct Weighed {
  V weight, first, second;
};

template <class T, WeightKind kKind>
class WeightLanes;

/// exp(-rho^2) with the taper of TaperedGaussian.
template <class T>
class WeightLanes<T, WeightKind::kGaussian> {
  using V = Vec<T>;

 public:
  explicit WeightLanes(V radius) {
    per_width_ = set(T{1}) / (radius - set(T(0.25)));
    scaled_radius_sq_ = radius * radius * per_width_;
  }

  HWY_INLINE V weight(V rho_sq) const {
    const V u = taper_argument(rho_sq);
    return gauss(rho_sq) * smoothstep(u);
  }

  HWY_INLINE Weighed<V> with_derivatives(V rho_sq) const {
    const V g = gauss(rho_sq);
    const V u = taper_argument(rho_sq);
    const V s = smoothstep(u);
    const V rest = fnma(u, u, u);  // u (1 - u)
    const V scaled = per_width_ * rest;
    const V s1 = set(T(-30)) * scaled * rest;
    const V s2 = set(T(60)) * per_width_ * scaled * fnma(set(T(2)), u, set(T(1)));
    return {g * s, g * (s1 - s), g * (fnma(set(T(2)), s1, s2) + s)};
  }

 private:
  HWY_INLINE static V gauss(V rho_sq) { return exp2<T>(rho_sq * set(T(-1.44269504088896341))); }
  HWY_INLINE V taper_argument(V rho_sq) const {
    const V u = fnma(rho_sq, per_width_, scaled_radius_sq_);
    return hn::Min(hn::Max(u, set(T(0))), set(T(1)));
  }
  HWY_INLINE static V smoothstep(V u) {
    return u * u * u * fnma(u, fnma(set(T(6)), u, set(T(15))), set(T(10)));
  }

  V per_width_, scaled_radius_sq_;
};

/// (1 - x)^4 (4 x + 1) of x = rho / R.
template <class T>
class WeightLanes<T, WeightKind::kWendland> {
  using V = Vec<T>;

 public:
  explicit WeightLanes(V radius) {
    per_radius_ = set(T{1}) / radius;
    per_radius_sq_ = per_radius_ * per_radius_;
  }

  HWY_INLINE V weight(V rho_sq) const {
    const V x = hn::Sqrt(rho_sq) * per_radius_;
    const V y = hn::Max(set(T(1)) - x, set(T(0)));
    const V y2 = y * y;
    return y2 * y2 * fma(set(T(4)), x, set(T(1)));
  }

  /// The second derivative is 15 (1 - x)^2 / (x R^4): singular at 0, where it only ever comes
  /// multiplied by heights that vanish faster.
  HWY_INLINE Weighed<V> with_derivatives(V rho_sq) const {
    const V x = hn::Sqrt(rho_sq) * per_radius_;
    const V y = hn::Max(set(T(1)) - x, set(T(0)));
    const V y2 = y * y;
    const V least = hn::Max(x, set(T(1e-6)));
    return {y2 * y2 * fma(set(T(4)), x, set(T(1))), set(T(-10)) * per_radius_sq_ * y2 * y,
            set(T(15)) * per_radius_sq_ * per_radius_sq_ * y2 / least};
  }

 private:
  V per_radius_, per_radius_sq_;
};

/// exp(-rho^2 / R^2) over all candidates, zero for padding.
template <class T>
class WeightLanes<T, WeightKind::kPcl> {
  using V = Vec<T>;

 public:
  explicit WeightLanes(V radius) {
    per_radius_sq_ = set(T{1}) / (radius * radius);
    scale_ = set(T(-1.44269504088896341)) * per_radius_sq_;
  }

  HWY_INLINE V weight(V rho_sq) const {
    const auto near = rho_sq < set(T(kFarAway * kFarAway));
    return hn::IfThenElseZero(near, exp2<T>(rho_sq * scale_));
  }

  HWY_INLINE Weighed<V> with_derivatives(V rho_sq) const {
    const V w = weight(rho_sq);
    const V first = hn::Neg(w * per_radius_sq_);
    return {w, first, hn::Neg(first * per_radius_sq_)};
  }

 private:
  V per_radius_sq_, scale_;
};

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
