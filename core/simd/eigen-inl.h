// Eigenvectors of a symmetric 3x3 matrix a lane.
#if defined(PSS_CORE_SIMD_EIGEN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_EIGEN_INL_H_
#undef PSS_CORE_SIMD_EIGEN_INL_H_
#else
#define PSS_CORE_SIMD_EIGEN_INL_H_
#endif

#include "core/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Symmetric matrices by their upper triangle.
template <class V>
struct Symmetric {
  V xx, xy, xz, yy, yz, zz;
};

/// Eigenvalues in ascending order, and the vectors of the smallest and the largest.
template <class V>
struct Eigen {
  V least, middle, most;
  Vec3<V> least_vector, most_vector;
};

/// One plane rotation of the Jacobi method: makes the element pq zero in the lanes of the mask. r
/// is the third axis.
template <class V, class M>
HWY_INLINE void rotate(M lanes, V& pp, V& qq, V& pq, V& pr, V& qr, Vec3<V>& p, Vec3<V>& q) {
  using T = hn::TFromV<V>;
  const V zero = set(T{0});
  const V one = set(T{1});
  // The tangent of the smaller angle, t = 2 pq / (d + sign(d) r), d = qq - pp,
  // r = sqrt(d^2 + 4 pq^2); its cosine by c^2 = (|d| + r) / 2 r, which does not wait for it.
  const V d = qq - pp;
  const V twice = pq + pq;
  const V root = hn::Sqrt(fma(d, d, twice * twice));
  const V sum = hn::Abs(d) + root;
  const auto turn = hn::And(lanes, sum > zero);
  const V t = hn::IfThenElseZero(turn, twice / hn::IfThenElse(turn, hn::CopySign(sum, d), one));
  const V cos_sq = sum / hn::IfThenElse(turn, root + root, one);
  const V c = hn::IfThenElse(turn, hn::Sqrt(cos_sq), one);
  const V s = t * c;
  pp = fnma(t, pq, pp);
  qq = fma(t, pq, qq);
  pq = hn::IfThenElse(turn, zero, pq);
  const V old_pr = pr;
  pr = fnma(s, qr, c * pr);
  qr = fma(s, old_pr, c * qr);
  const Vec3<V> old = p;
  p = {fnma(s, q.x, c * p.x), fnma(s, q.y, c * p.y), fnma(s, q.z, c * p.z)};
  q = {fma(s, old.x, c * q.x), fma(s, old.y, c * q.y), fma(s, old.z, c * q.z)};
}

/// Exchanges two eigenpairs where the first value is larger.
template <class V>
HWY_INLINE void order(V& a, V& b, Vec3<V>& va, Vec3<V>& vb) {
  const auto swap = hn::Gt(a, b);
  const V small = hn::IfThenElse(swap, b, a);
  b = hn::IfThenElse(swap, a, b);
  a = small;
  const Vec3<V> first = select(swap, vb, va);
  vb = select(swap, va, vb);
  va = first;
}

/// Where the elements off the diagonal are more than a rounding of those on it.
template <class V>
HWY_INLINE auto is_coupled(const Symmetric<V>& m) {
  using T = hn::TFromV<V>;
  constexpr T kRounding = sizeof(T) == 4 ? T(0x1p-25) : T(0x1p-54);
  const V off = hn::Max(hn::Max(hn::Abs(m.xy), hn::Abs(m.xz)), hn::Abs(m.yz));
  const V on = hn::Max(hn::Max(hn::Abs(m.xx), hn::Abs(m.yy)), hn::Abs(m.zz));
  return off > set(kRounding) * on;
}

/// Source: cyclic Jacobi: Golub, Van Loan, "Matrix Computations", section 8.5. Each sweep squares
///         the error or better; a lane makes those that it needs, whatever the others do.
template <class V>
HWY_INLINE Eigen<V> eigen_decomposition(Symmetric<V> m) {
  using T = hn::TFromV<V>;
  constexpr int kMostSweeps = sizeof(T) == 4 ? 4 : 5;
  const V zero = set(T{0});
  const V one = set(T{1});
  Vec3<V> x{one, zero, zero}, y{zero, one, zero}, z{zero, zero, one};
  auto lanes = is_coupled(m);
  for (int sweep = 0; sweep < kMostSweeps && !hn::AllFalse(Tag<T>(), lanes); ++sweep) {
    rotate(lanes, m.xx, m.yy, m.xy, m.xz, m.yz, x, y);
    rotate(lanes, m.xx, m.zz, m.xz, m.xy, m.yz, x, z);
    rotate(lanes, m.yy, m.zz, m.yz, m.xy, m.xz, y, z);
    lanes = hn::And(lanes, is_coupled(m));
  }
  order(m.xx, m.yy, x, y);
  order(m.yy, m.zz, y, z);
  order(m.xx, m.yy, x, y);
  return {m.xx, m.yy, m.zz, x, z};
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
