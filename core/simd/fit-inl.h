// The local polynomial across lanes: moments, normal equations, and what they tell of the surface.
#if defined(PSS_CORE_SIMD_FIT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_FIT_INL_H_
#undef PSS_CORE_SIMD_FIT_INL_H_
#else
#define PSS_CORE_SIMD_FIT_INL_H_
#endif

#include "core/method.h"
#include "core/simd/stage-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Coefficients of a polynomial of this total degree in two variables.
constexpr std::size_t coefficient_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
}

/// Weighted moments about the foot point: w x^i y^j, w d x^i y^j, and what other outputs need.
template <class T, int kDegree>
struct Moments {
  using V = Vec<T>;
  // Two orders are always there: the boundary value needs them.
  static constexpr int kOrder = kDegree == 0 ? 2 : 2 * kDegree;

  V area[kOrder + 1][kOrder + 1];
  V height[kDegree + 1][kDegree + 1];
  V dd, dddd;          // w d^2, w d^4
  V count, near, far;  // neighbours; those over the unit disc, at most 1/2 from the plane or more
};

/// The rows i in [kFirst, kLast) of the area moments.
template <int kFirst, int kLast, class T, int kDegree>
HWY_INLINE void add_area(const Stage<T>& stage, std::size_t count, Moments<T, kDegree>& m) {
  using V = Vec<T>;
  constexpr int kOrder = Moments<T, kDegree>::kOrder;
  constexpr int kPowers = kOrder - kFirst + 1;
  V sum[kLast - kFirst][kPowers];
#pragma GCC unroll 16
  for (int i = kFirst; i < kLast; ++i)
#pragma GCC unroll 16
    for (int j = 0; j <= kOrder - i; ++j) sum[i - kFirst][j] = m.area[i][j];
  for (std::size_t k = 0; k < count * kLanes<T>; k += kLanes<T>) {
    const V x = load(stage.x + k);
    const V y = load(stage.y + k);
    V wx = load(stage.w + k);
    V power[kPowers];
    power[0] = y;  // not used
    if constexpr (kPowers > 1) power[1] = y;
#pragma GCC unroll 16
    for (int j = 2; j < kPowers; ++j) power[j] = power[j - 1] * y;
#pragma GCC unroll 16
    for (int i = 0; i < kFirst; ++i) wx = wx * x;
#pragma GCC unroll 16
    for (int i = kFirst; i < kLast; ++i) {
      sum[i - kFirst][0] = sum[i - kFirst][0] + wx;
#pragma GCC unroll 16
      for (int j = 1; j <= kOrder - i; ++j)
        sum[i - kFirst][j] = fma(wx, power[j], sum[i - kFirst][j]);
      wx = wx * x;
    }
  }
#pragma GCC unroll 16
  for (int i = kFirst; i < kLast; ++i)
#pragma GCC unroll 16
    for (int j = 0; j <= kOrder - i; ++j) m.area[i][j] = sum[i - kFirst][j];
}

/// The end of the rows from `first` on whose sums registers hold.
constexpr int rows_at_once(int order, int first) {
  constexpr int kMostSums = HWY_TARGET == HWY_AVX2 ? 9 : 17;
  int last = first;
  for (int sums = 0; last <= order && (sums += order - last + 1) <= kMostSums;) ++last;
  return last;
}

/// The rows from kFirst on, as many at once as there are registers for.
template <int kFirst, class T, int kDegree>
HWY_INLINE void add_areas(const Stage<T>& stage, std::size_t count, Moments<T, kDegree>& m) {
  constexpr int kOrder = Moments<T, kDegree>::kOrder;
  constexpr int kLast = rows_at_once(kOrder, kFirst);
  add_area<kFirst, kLast>(stage, count, m);
  if constexpr (kLast <= kOrder) add_areas<kLast>(stage, count, m);
}

/// The moments of the heights.
template <class T, int kDegree>
HWY_INLINE void add_heights(const Stage<T>& stage, std::size_t count, Moments<T, kDegree>& m) {
  using V = Vec<T>;
  V sum[kDegree + 1][kDegree + 1];
#pragma GCC unroll 16
  for (int i = 0; i <= kDegree; ++i)
#pragma GCC unroll 16
    for (int j = 0; j <= kDegree - i; ++j) sum[i][j] = m.height[i][j];
  V dd = m.dd, dddd = m.dddd;
  for (std::size_t k = 0; k < count * kLanes<T>; k += kLanes<T>) {
    const V x = load(stage.x + k);
    const V y = load(stage.y + k);
    const V d = load(stage.d + k);
    V wdx = load(stage.w + k) * d;
    const V wdd = wdx * d;
    dd = dd + wdd;
    dddd = fma(wdd, d * d, dddd);
    V power[kDegree + 1];
    power[0] = y;  // not used
    if constexpr (kDegree > 0) power[1] = y;
#pragma GCC unroll 16
    for (int j = 2; j <= kDegree; ++j) power[j] = power[j - 1] * y;
#pragma GCC unroll 16
    for (int i = 0; i <= kDegree; ++i) {
      sum[i][0] = sum[i][0] + wdx;
#pragma GCC unroll 16
      for (int j = 1; j <= kDegree - i; ++j) sum[i][j] = fma(wdx, power[j], sum[i][j]);
      wdx = wdx * x;
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i <= kDegree; ++i)
#pragma GCC unroll 16
    for (int j = 0; j <= kDegree - i; ++j) m.height[i][j] = sum[i][j];
  m.dd = dd;
  m.dddd = dddd;
}

/// How many neighbours there are, and how many of those over the unit disc lie off the plane.
template <class T, int kDegree>
HWY_INLINE void add_counts(const Stage<T>& stage, std::size_t count, Vec<T> radius_sq,
                           Moments<T, kDegree>& m) {
  using V = Vec<T>;
  const V one = set(T{1});
  V all = m.count, near = m.near, far = m.far;
  for (std::size_t k = 0; k < count * kLanes<T>; k += kLanes<T>) {
    const V x = load(stage.x + k);
    const V y = load(stage.y + k);
    const V d = load(stage.d + k);
    const V across = fma(x, x, y * y);
    const auto neighbour = fma(d, d, across) < radius_sq;
    const auto over = hn::And(neighbour, across < one);
    const auto off = hn::Abs(d) > set(T(0.5));
    all = all + hn::IfThenElseZero(neighbour, one);
    near = near + hn::IfThenElseZero(hn::AndNot(off, over), one);
    far = far + hn::IfThenElseZero(hn::And(off, over), one);
  }
  m.count = all;
  m.near = near;
  m.far = far;
}

/// All moments of the balls, seen from `foot`: its coordinates in the axes.
template <int kDegree, class T, class W>
HWY_INLINE void sum_moments(const Balls<T>& balls, const W& weight, Vec<T> radius,
                            const Axes<Vec<T>>& axes, const Vec3<Vec<T>>& foot, Stage<T>& stage,
                            Moments<T, kDegree>& m) {
  const auto zero = set(T{0});
  for (auto& row : m.area)
    for (auto& v : row) v = zero;
  for (auto& row : m.height)
    for (auto& v : row) v = zero;
  m.dd = m.dddd = m.count = m.near = m.far = zero;
  const auto radius_sq = radius * radius;
  for (std::size_t begin = 0; begin < balls.steps; begin += Stage<T>::kSteps) {
    const std::size_t count = HWY_MIN(Stage<T>::kSteps, balls.steps - begin);
    fill<false, T>(balls, begin, count, axes, foot, weight, stage);
    add_areas<0>(stage, count, m);
    add_heights(stage, count, m);
    add_counts(stage, count, radius_sq, m);
  }
}

/// A fitted height field g(x, y) a lane over its plane, all in units of its h.
template <class T>
struct Maps {
  using V = Vec<T>;

  V coefficient[coefficient_count(kMostDegree)];  // of 1, x, y, x^2, ...; zero beyond the degree
  V degree;                                       // that is determined; -1 where there is none
  V residual;                                     // weighted rms of g - d
  V boundary;                                     // |weighted mean - q| / weighted rms distance
  V count;                                        // neighbours nearer to q than the radius
  Mask<T> second_sheet;
  Mask<T> sound;  // every pivot of the degree asked for is large enough
};

/// The exponents of monomial number k.
struct Monomial {
  int x, y;
};

constexpr Monomial monomial(int k) {
  int total = 0;
  while ((total + 1) * (total + 2) / 2 <= k) ++total;
  const int j = k - total * (total + 1) / 2;
  return {total - j, j};
}

/// Solves the normal equations as L D L^T, of the highest degree that the pivots allow.
template <int kDegree, class T>
HWY_NOINLINE Maps<T> solve(const Moments<T, kDegree>& m) {
  using V = Vec<T>;
  constexpr int kCount = static_cast<int>(coefficient_count(kDegree));
  const V zero = set(T{0});
  const V one = set(T{1});
  V lower[kCount][kCount];
  V per_pivot[kCount];
  V right[kCount];
  V degree = set(T(kDegree));
  auto sound = hn::Eq(zero, zero);
#pragma GCC unroll 16
  for (int j = 0; j < kCount; ++j) {
    const Monomial mj = monomial(j);
    V scaled[kCount];
    const V diagonal = m.area[2 * mj.x][2 * mj.y];
    V pivot = diagonal;
#pragma GCC unroll 16
    for (int k = 0; k < j; ++k) {
      const Monomial mk = monomial(k);
      V s = m.area[mj.x + mk.x][mj.y + mk.y];
#pragma GCC unroll 16
      for (int l = 0; l < k; ++l) s = fnma(scaled[l], lower[k][l], s);
      scaled[k] = s;
      lower[j][k] = s * per_pivot[k];
      pivot = fnma(s, lower[j][k], pivot);
    }
    const auto determined = pivot > set(Tolerance<T>::kLeastPivot) * diagonal;
    const V below = set(T(mj.x + mj.y - 1));
    degree = hn::IfThenElse(hn::Or(determined, degree <= below), degree, below);
    per_pivot[j] = hn::IfThenElseZero(determined, one / hn::IfThenElse(determined, pivot, one));
  }
  sound = hn::Eq(degree, set(T(kDegree)));
  V explained = zero;
#pragma GCC unroll 16
  for (int j = 0; j < kCount; ++j) {
    const Monomial mj = monomial(j);
    V r = m.height[mj.x][mj.y];
#pragma GCC unroll 16
    for (int k = 0; k < j; ++k) r = fnma(lower[j][k], right[k], r);
    right[j] = hn::IfThenElseZero(degree >= set(T(mj.x + mj.y)), r);
    explained = fma(right[j] * right[j], per_pivot[j], explained);
  }
  Maps<T> map;
  for (auto& c : map.coefficient) c = zero;
#pragma GCC unroll 16
  for (int j = kCount - 1; j >= 0; --j) {
    V c = right[j] * per_pivot[j];
#pragma GCC unroll 16
    for (int k = j + 1; k < kCount; ++k) c = fnma(lower[k][j], map.coefficient[k], c);
    // A lane of lower degree has zeros above, so this only drops its own rounding.
    const Monomial mj = monomial(j);
    map.coefficient[j] = hn::IfThenElseZero(degree >= set(T(mj.x + mj.y)), c);
  }
  const V w = m.area[0][0];
  const auto some = w > zero;
  const V per_w = one / hn::IfThenElse(some, w, one);
  map.degree = degree;
  map.sound = sound;
  map.residual = hn::Sqrt(hn::Max(m.dd - explained, zero) * per_w);
  const V mean_sq = fma(m.area[1][0], m.area[1][0],
                        fma(m.area[0][1], m.area[0][1], m.height[0][0] * m.height[0][0]));
  const V square = m.area[2][0] + m.area[0][2] + m.dd;
  const auto spread = square > zero;
  map.boundary =
      hn::IfThenElseZero(spread, hn::Sqrt(mean_sq / hn::IfThenElse(spread, w * square, one)));
  map.count = m.count;
  const auto thick = m.dd > set(T(0.01)) * w;
  const auto split = hn::And(thick, w * m.dddd < set(T(1.5)) * m.dd * m.dd);
  map.second_sheet = hn::Or(set(T{4}) * m.far > m.near, split);
  return map;
}

template <int kDegree, class T, class W>
HWY_NOINLINE Maps<T> fit(const Balls<T>& balls, const W& weight, Vec<T> radius,
                         const Axes<Vec<T>>& axes, const Vec3<Vec<T>>& foot, Stage<T>& stage) {
  Moments<T, kDegree> moments;
  sum_moments<kDegree, T>(balls, weight, radius, axes, foot, stage, moments);
  return solve<kDegree, T>(moments);
}

template <class T, class W>
Maps<T> fit(int degree, const Balls<T>& balls, const W& weight, Vec<T> radius,
            const Axes<Vec<T>>& axes, const Vec3<Vec<T>>& foot, Stage<T>& stage) {
  switch (degree) {
    case 0:
      return fit<0, T>(balls, weight, radius, axes, foot, stage);
    case 1:
      return fit<1, T>(balls, weight, radius, axes, foot, stage);
    case 2:
      return fit<2, T>(balls, weight, radius, axes, foot, stage);
    case 3:
      return fit<3, T>(balls, weight, radius, axes, foot, stage);
    default:
      return fit<4, T>(balls, weight, radius, axes, foot, stage);
  }
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
