// What lanes found, turned into projections: normal and curvatures of the polynomial.
#if defined(PSS_CORE_SIMD_RESULT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_RESULT_INL_H_
#undef PSS_CORE_SIMD_RESULT_INL_H_
#else
#define PSS_CORE_SIMD_RESULT_INL_H_
#endif

#include "core/projection.h"
#include "core/simd/fit-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// The numbers of every lane, in units of its h, side by side.
template <class T>
struct Outcomes {
  enum Field {
    kMove,
    kNormal = 3,
    kDirection = 6,
    kMean = 9,
    kGaussian,
    kResidual,
    kBoundary,
    kCount,
    kDegree,
    kSecondSheet,
    kStatus,  // 0, or the Status of a lane that stays
    kEasy,
    kFinite,  // 1 where all the others are
    kFields
  };

  alignas(64) T value[kFields][kLanes<T>];

  World3 vector(int field, std::size_t lane) const {
    return {value[field][lane], value[field + 1][lane], value[field + 2][lane]};
  }

  /// Looks through all other fields.
  void judge() {
    Vec<T> sum = set(T{0});  // zeros, unless a number is not finite
    for (int field = 0; field < kFinite; ++field) sum = sum + load(value[field]) * set(T{0});
    store(hn::IfThenElseZero(hn::Eq(sum, set(T{0})), set(T{1})), value[kFinite]);
  }

  /// Fills in the projection of a lane; false where the lane's query needs another computation.
  bool write(std::size_t lane, double h, int degree, Projection& p) const {
    if (!(value[kEasy][lane] > 0)) return false;
    const bool finite = value[kFinite][lane] > 0;
    if (value[kStatus][lane] > 0 || !finite) {
      p = Projection{};
      p.status = finite ? static_cast<Status>(static_cast<int>(value[kStatus][lane]))
                        : Status::kDegenerate;
      p.neighbours = static_cast<std::uint32_t>(value[kCount][lane]);
      return true;
    }
    p.status = value[kDegree][lane] < static_cast<T>(degree) ? Status::kDegreeReduced : Status::kOk;
    p.second_sheet = value[kSecondSheet][lane] > 0;
    p.redone = false;
    p.neighbours = static_cast<std::uint32_t>(value[kCount][lane]);
    const World3 move = vector(kMove, lane);
    p.displacement = {h * move[0], h * move[1], h * move[2]};
    p.normal = vector(kNormal, lane);
    p.mean_curvature = value[kMean][lane] / h;
    p.gaussian_curvature = value[kGaussian][lane] / h / h;
    p.principal_direction = vector(kDirection, lane);
    p.residual = value[kResidual][lane] * h;
    p.boundary = value[kBoundary][lane];
    return true;
  }
};

template <class T>
HWY_INLINE void keep(Outcomes<T>& o, int field, const Vec3<Vec<T>>& v) {
  store(v.x, o.value[field]);
  store(v.y, o.value[field + 1]);
  store(v.z, o.value[field + 2]);
}

/// Curvatures of z = g(x, y) at the origin and the direction of the larger one, by the normal's
/// final sign: the side of the axes' n, or the other where it flips. The direction is tangent to
/// the polynomial, or lies in the axes' plane where the normal is not the polynomial's.
///
/// Source: any text on differential geometry, e.g. do Carmo 1976, section 3-3.
template <class T>
HWY_INLINE void keep_curvatures(const Maps<T>& map, const Axes<Vec<T>>& axes, bool in_plane,
                                Mask<T> flip, Outcomes<T>& o) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V one = set(T{1});
  const V gu = map.coefficient[1];
  const V gv = map.coefficient[2];
  const V guu = map.coefficient[3] + map.coefficient[3];
  const V guv = map.coefficient[4];
  const V gvv = map.coefficient[5] + map.coefficient[5];
  const V e = fma(gu, gu, one);
  const V f = gu * gv;
  const V g = fma(gv, gv, one);
  const V z = fma(gv, gv, e);
  const V root = hn::Sqrt(z);
  const V bend = fma(g, guu, fma(e, gvv, hn::Neg((f + f) * guv)));
  const V mean = bend * set(T(0.5)) / (z * root);
  const V gauss = fma(guu, gvv, hn::Neg(guv * guv)) / (z * z);
  // The larger curvature by the final sign: the smaller one where it flips.
  const V spread_sq = hn::Max(fma(mean, mean, hn::Neg(gauss)), zero);
  const V spread = hn::Sqrt(spread_sq);
  const V k = hn::IfThenElse(flip, mean - spread, mean + spread) * root;
  const V a0 = fnma(k, e, guu);
  const V b0 = fnma(k, f, guv);
  const V b1 = fnma(k, g, gvv);
  const auto first = fma(a0, a0, b0 * b0) >= fma(b0, b0, b1 * b1);
  const V a = hn::Neg(hn::IfThenElse(first, b0, b1));
  const V b = hn::IfThenElse(first, a0, b0);
  const V c = in_plane ? zero : fma(a, gu, b * gv);
  const Vec3<V> tangent = a * axes.u + b * axes.v + c * axes.n;
  const V length_sq = dot(tangent, tangent);
  constexpr T kRound = sizeof(T) == 4 ? T(1e-6) : T(1e-12);
  const auto known = hn::And(spread_sq > set(kRound) * mean * mean, length_sq > set(T(1e-30)));
  const V per_length =
      hn::IfThenElseZero(known, one / hn::Sqrt(hn::IfThenElse(known, length_sq, one)));
  const Vec3<V> direction = per_length * tangent;
  keep(o, Outcomes<T>::kDirection,
       negated_where(hn::AndNot(is_canonical(direction), known), direction));
  store(hn::IfThenElse(flip, hn::Neg(mean), mean), o.value[Outcomes<T>::kMean]);
  store(gauss, o.value[Outcomes<T>::kGaussian]);
}

/// Normal, with its canonical sign, and curvatures of z = g(x, y) at the origin.
template <class T>
HWY_INLINE void keep_shape(const Maps<T>& map, const Axes<Vec<T>>& axes, Outcomes<T>& o) {
  using V = Vec<T>;
  const V gu = map.coefficient[1];
  const V gv = map.coefficient[2];
  const V one = set(T{1});
  const V per_root = one / hn::Sqrt(fma(gv, gv, fma(gu, gu, one)));
  const Vec3<V> up{fnma(gu, axes.u.x, fnma(gv, axes.v.x, axes.n.x)),
                   fnma(gu, axes.u.y, fnma(gv, axes.v.y, axes.n.y)),
                   fnma(gu, axes.u.z, fnma(gv, axes.v.z, axes.n.z))};
  const Vec3<V> normal = per_root * up;
  const auto flip = hn::Not(is_canonical(normal));
  keep(o, Outcomes<T>::kNormal, negated_where(flip, normal));
  keep_curvatures<T>(map, axes, false, flip, o);
}

/// What the fit tells of the neighbourhood, wherever the point goes.
template <class T>
HWY_INLINE void keep_fit(const Maps<T>& map, Outcomes<T>& o) {
  store(map.residual, o.value[Outcomes<T>::kResidual]);
  store(map.boundary, o.value[Outcomes<T>::kBoundary]);
  store(map.count, o.value[Outcomes<T>::kCount]);
  store(map.degree, o.value[Outcomes<T>::kDegree]);
  store(hn::IfThenElseZero(map.second_sheet, set(T{1})), o.value[Outcomes<T>::kSecondSheet]);
}

/// The outcome of a plane and the polynomial over it.
template <class T>
HWY_INLINE Outcomes<T> describe(const Planes<T>& plane, const Axes<Vec<T>>& axes,
                                const Maps<T>& map) {
  using V = Vec<T>;
  const V zero = set(T{0});
  const V one = set(T{1});
  Outcomes<T> o;
  const V height = map.coefficient[0];
  keep(o, Outcomes<T>::kMove, (plane.t + height) * plane.n);
  keep_shape<T>(map, axes, o);
  keep_fit<T>(map, o);
  const auto inside = hn::Abs(height) < set(Tolerance<T>::kFarthest);
  const auto fitted = map.degree >= zero;
  auto easy = plane.easy;
  if constexpr (!Tolerance<T>::kDecides)
    easy = hn::And(hn::And(easy, fitted), hn::And(map.sound, inside));
  const V moved = hn::IfThenElse(inside, zero, status_code<T>(Status::kOutOfDomain));
  const V found = hn::IfThenElse(fitted, moved, status_code<T>(Status::kTooFew));
  store(hn::IfThenElse(hn::Eq(plane.status, zero), found, plane.status),
        o.value[Outcomes<T>::kStatus]);
  store(hn::IfThenElseZero(easy, one), o.value[Outcomes<T>::kEasy]);
  o.judge();
  return o;
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
