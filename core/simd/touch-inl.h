// Which chunks of candidates a query has to look at.
#if defined(PSS_CORE_SIMD_TOUCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_TOUCH_INL_H_
#undef PSS_CORE_SIMD_TOUCH_INL_H_
#else
#define PSS_CORE_SIMD_TOUCH_INL_H_
#endif

#include <cmath>

#include "core/simd/candidates-inl.h"
#include "core/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// One query as the filter sees it.
struct Seeker {
  const Query& query;
  Index3 position;  // relative to the candidates'
  double h, per_h;
  double reach_sq;

  Seeker(const Query& q, double width, double reach, const Candidates& candidates)
      : query(q),
        position(candidates.relative(q.position)),
        h(width),
        per_h(1 / width),
        reach_sq(reach * reach) {}
};

template <class T>
HWY_INLINE Vec<T> as(Vec<T> v) {
  return v;
}
template <class T>
HWY_INLINE Vec<T> as(hn::Vec<hn::Rebind<std::int32_t, Tag<float>>> v) {
  return hn::ConvertTo(Tag<T>(), v);
}

/// One axis of a query's distances from boxes, in units of its h.
///
/// In T, with room for its rounding: what is decided with it only saves work.
template <class T, class I>
struct Gap {
  using D = hn::Rebind<I, Tag<T>>;
  const I* low;
  const I* high;
  hn::Vec<D> position;
  Vec<T> scale, slack;

  Gap(const simd::CandidateChunks<I>& chunks, const Seeker& seeker, const Lattice& lattice,
      std::size_t axis)
      : low(chunks.low[axis].data()),
        high(chunks.high[axis].data()),
        position(hn::Set(D(), static_cast<I>(seeker.position[axis]))),
        scale(set(static_cast<T>(lattice.scale[axis] * seeker.per_h))),
        slack(set(static_cast<T>(std::abs(seeker.query.remainder[axis]) * seeker.per_h))) {}

  HWY_INLINE Vec<T> operator()(std::size_t c) const {
    const auto below = hn::LoadU(D(), low + c) - position;
    const auto above = position - hn::LoadU(D(), high + c);
    const Vec<T> steps = as<T>(hn::Max(below, above));
    return hn::Max(steps * scale - slack, set(T{0}));
  }
};

/// Lists where the chunks begin whose box the query's ball may touch; returns how many.
template <class T, class I, class Begin>
HWY_INLINE std::size_t touch(const simd::CandidateChunks<I>& chunks, std::size_t count,
                             const Lattice& lattice, const Seeker& seeker, Begin* out) {
  const Tag<T> d;
  const hn::RebindToSigned<Tag<T>> index;
  static_assert(sizeof(Begin) == sizeof(T));
  const Gap<T, I> x(chunks, seeker, lattice, 0), y(chunks, seeker, lattice, 1),
      z(chunks, seeker, lattice, 2);
  const Vec<T> limit =
      set(static_cast<T>(seeker.reach_sq * seeker.per_h * seeker.per_h * (1 + 1e-5)));
  constexpr Begin kStep = static_cast<Begin>(simd::kChunk);
  const auto steps = hn::Iota(index, Begin{0}) * hn::Set(index, kStep);
  std::size_t touched = 0;
  for (std::size_t c = 0; c < count; c += kLanes<T>) {
    const Vec<T> dx = x(c), dy = y(c), dz = z(c);
    auto mask = fma(dx, dx, fma(dy, dy, dz * dz)) <= limit;
    if (count < c + kLanes<T>) mask = hn::And(mask, hn::FirstN(d, count - c));
    const auto begins = steps + hn::Set(index, static_cast<Begin>(c) * kStep);
    hn::StoreU(compress(begins, hn::RebindMask(index, mask)), index, out + touched);
    touched += hn::CountTrue(d, mask);
  }
  return touched;
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
