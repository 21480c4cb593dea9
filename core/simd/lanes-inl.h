// Vectors of queries: one query a lane, every operation the same in every lane and target.
//
// Compiled once for each target; see project.cpp.
#if defined(PSS_CORE_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_LANES_INL_H_
#undef PSS_CORE_SIMD_LANES_INL_H_
#else
#define PSS_CORE_SIMD_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Tag = hn::ScalableTag<T>;
template <class T>
using Vec = hn::Vec<Tag<T>>;
template <class T>
using Mask = hn::Mask<Tag<T>>;
template <class T>
inline constexpr std::size_t kLanes = hn::MaxLanes(Tag<T>());

template <class T>
HWY_INLINE Vec<T> set(T value) {
  return hn::Set(Tag<T>(), value);
}

template <class T>
HWY_INLINE Vec<T> load(const T* from) {
  return hn::Load(Tag<T>(), from);
}

template <class V>
HWY_INLINE void store(V v, hn::TFromV<V>* to) {
  hn::Store(v, hn::DFromV<V>(), to);
}

/// No lane.
template <class T>
HWY_INLINE Mask<T> none() {
  return hn::Ne(hn::Zero(Tag<T>()), hn::Zero(Tag<T>()));
}

/// a b + c, rounded once in every target: where the machine cannot, std::fma does it.
template <class V>
HWY_INLINE V fma(V a, V b, V c) {
#if HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  using T = hn::TFromV<V>;
  const hn::DFromV<V> d;
  alignas(16) T x[hn::MaxLanes(d)], y[hn::MaxLanes(d)], z[hn::MaxLanes(d)];
  hn::Store(a, d, x);
  hn::Store(b, d, y);
  hn::Store(c, d, z);
  for (std::size_t i = 0; i < hn::MaxLanes(d); ++i) z[i] = std::fma(x[i], y[i], z[i]);
  return hn::Load(d, z);
#else
  return hn::MulAdd(a, b, c);
#endif
}

/// c - a b, rounded once.
template <class V>
HWY_INLINE V fnma(V a, V b, V c) {
#if HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  return fma(hn::Neg(a), b, c);
#else
  return hn::NegMulAdd(a, b, c);
#endif
}

/// Three coordinates of each lane.
template <class V>
struct Vec3 {
  V x, y, z;
};

template <class V>
HWY_INLINE Vec3<V> operator+(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
HWY_INLINE Vec3<V> operator*(V s, const Vec3<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
/// s a + b
template <class V>
HWY_INLINE Vec3<V> fma(V s, const Vec3<V>& a, const Vec3<V>& b) {
  return {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)};
}
template <class V>
HWY_INLINE V dot(const Vec3<V>& a, const Vec3<V>& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <class V>
HWY_INLINE Vec3<V> normalized(const Vec3<V>& a) {
  using T = hn::TFromV<V>;
  return (set(T{1}) / hn::Sqrt(dot(a, a))) * a;
}
template <class M, class V>
HWY_INLINE Vec3<V> select(M mask, const Vec3<V>& yes, const Vec3<V>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
template <class M, class V>
HWY_INLINE Vec3<V> negated_where(M mask, const Vec3<V>& a) {
  return select(mask, Vec3<V>{hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}, a);
}

/// A right-handed orthonormal frame a lane.
template <class V>
struct Axes {
  Vec3<V> u, v, n;
};

/// The frame whose in-plane axes are a pure function of the unit vector n.
///
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
template <class V>
HWY_INLINE Axes<V> axes_of(const Vec3<V>& n) {
  using T = hn::TFromV<V>;
  const V one = set(T{1});
  const V sign = hn::CopySign(one, n.z);
  const V a = hn::Neg(one / (sign + n.z));
  const V b = n.x * n.y * a;
  const V sx = sign * n.x;
  return {{fma(sx * n.x, a, one), sign * b, hn::Neg(sx)},
          {b, fma(n.y * n.y, a, sign), hn::Neg(n.y)},
          n};
}

/// Where the component of largest magnitude, the first of equals, is positive.
template <class V>
HWY_INLINE auto is_canonical(const Vec3<V>& n) {
  V largest = n.x;
  largest = hn::IfThenElse(hn::Gt(hn::Abs(n.y), hn::Abs(largest)), n.y, largest);
  largest = hn::IfThenElse(hn::Gt(hn::Abs(n.z), hn::Abs(largest)), n.z, largest);
  return hn::Gt(largest, hn::Zero(hn::DFromV<V>()));
}

/// 2^y within about 2 roundings; y below the exponents' range counts as its lower end.
///
/// Source: y = k + f, |f| <= 1/2, Taylor series of 2^f: remainder below 2^-24 and 2^-56.
template <class T>
HWY_INLINE Vec<T> exp2(Vec<T> y) {
  const Tag<T> d;
  const hn::RebindToUnsigned<Tag<T>> bits;
  constexpr bool kSingle = sizeof(T) == 4;
  constexpr T kShift = kSingle ? T(0x1.8p23) : T(0x1.8p52);
  constexpr T kLowest = kSingle ? T(-125) : T(-1020);
  const auto low = hn::Max(y, set(kLowest));
  const auto shifted = low + set(kShift);
  const auto f = low - (shifted - set(kShift));
  // ln2^n / n!
  constexpr double kTerms[] = {1,
                               0.693147180559945309,
                               0.240226506959100712,
                               0.0555041086648215800,
                               0.00961812910762847716,
                               0.00133335581464284434,
                               0.000154035303933816099,
                               1.52527338040598403e-5,
                               1.32154867901443095e-6,
                               1.01780860092396997e-7,
                               7.05491162080112333e-9,
                               4.44553827187081150e-10,
                               2.56784359934882051e-11,
                               1.36914888539041289e-12};
  constexpr int kDegree = kSingle ? 6 : 13;
  auto p = set(static_cast<T>(kTerms[kDegree]));
#pragma GCC unroll 16
  for (int n = kDegree - 1; n >= 0; --n) p = fma(p, f, set(static_cast<T>(kTerms[n])));
  // The low bits of `shifted` hold k, which is added to the exponent.
  const auto exponent = hn::ShiftLeft < kSingle ? 23 : 52 > (hn::BitCast(bits, shifted));
  return hn::BitCast(d, hn::BitCast(bits, p) + exponent);
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
