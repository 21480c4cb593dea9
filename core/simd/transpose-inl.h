// Rows of neighbours turned into columns: one lane a row.
#if defined(PSS_CORE_SIMD_TRANSPOSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_TRANSPOSE_INL_H_
#undef PSS_CORE_SIMD_TRANSPOSE_INL_H_
#else
#define PSS_CORE_SIMD_TRANSPOSE_INL_H_
#endif

#include <algorithm>

#include "core/simd/lanes-inl.h"
#include "core/simd/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// The buffer's numbers, filled up from `count` to `size` with `value`.
template <class T>
HWY_INLINE const T* padded(simd::Buffer<T>& buffer, std::size_t count, std::size_t size, T value) {
  buffer.reserve(size + kLanes<T>, count);
  for (std::size_t k = count; k < size; k += kLanes<T>)
    hn::StoreU(set(value), Tag<T>(), buffer.data() + k);
  return buffer.data();
}

#if HWY_TARGET == HWY_SCALAR
template <class T>
HWY_INLINE void transpose(const T* const* rows, std::size_t steps, T* to) {
  std::copy_n(rows[0], steps, to);
}
#else
/// Within each 128-bit block, makes columns of the four rows that the vectors hold.
HWY_INLINE void transpose_blocks(Vec<float>* v) {
  const Tag<float> d;
  const hn::RepartitionToWide<Tag<float> > pairs;
  const auto a = hn::BitCast(pairs, hn::InterleaveLower(d, v[0], v[1]));
  const auto b = hn::BitCast(pairs, hn::InterleaveUpper(d, v[0], v[1]));
  const auto c = hn::BitCast(pairs, hn::InterleaveLower(d, v[2], v[3]));
  const auto e = hn::BitCast(pairs, hn::InterleaveUpper(d, v[2], v[3]));
  v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, a, c));
  v[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, a, c));
  v[2] = hn::BitCast(d, hn::InterleaveLower(pairs, b, e));
  v[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, b, e));
}
/// The same of two rows.
HWY_INLINE void transpose_blocks(Vec<double>* v) {
  const Tag<double> d;
  const auto a = hn::InterleaveLower(d, v[0], v[1]);
  v[1] = hn::InterleaveUpper(d, v[0], v[1]);
  v[0] = a;
}

/// Gives block b of v[k * stride] to block k of v[b * stride], for as many as a vector has blocks.
template <class T>
HWY_INLINE void exchange_blocks(Vec<T>* v, std::size_t stride) {
  const Tag<T> d;
  constexpr std::size_t kBlocks = kLanes<T> * sizeof(T) / 16;
  static_assert(kBlocks == 1 || kBlocks == 2 || kBlocks == 4);
  if constexpr (kBlocks == 2) {
    const Vec<T> a = v[0], b = v[stride];
    v[0] = hn::ConcatLowerLower(d, b, a);
    v[stride] = hn::ConcatUpperUpper(d, b, a);
  } else if constexpr (kBlocks == 4) {
    const Vec<T> a = hn::ConcatLowerLower(d, v[2 * stride], v[0]);
    const Vec<T> b = hn::ConcatLowerLower(d, v[3 * stride], v[stride]);
    const Vec<T> c = hn::ConcatUpperUpper(d, v[2 * stride], v[0]);
    const Vec<T> e = hn::ConcatUpperUpper(d, v[3 * stride], v[stride]);
    v[0] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
    v[stride] = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
    v[2 * stride] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(e), c);
    v[3 * stride] = hn::OddEvenBlocks(e, hn::SwapAdjacentBlocks(c));
  }
}

/// Copies a row a lane, padded to a whole number of vectors, to [k][lane].
template <class T>
HWY_INLINE void transpose(const T* const* rows, std::size_t steps, T* to) {
  constexpr std::size_t kLanesOf = kLanes<T>;
  constexpr std::size_t kRows = 16 / sizeof(T);  // as a 128-bit block holds
  for (std::size_t k = 0; k < steps; k += kLanesOf) {
    Vec<T> v[kLanesOf];
#pragma GCC unroll 16
    for (std::size_t r = 0; r < kLanesOf; ++r) v[r] = load(rows[r] + k);
#pragma GCC unroll 16
    for (std::size_t r = 0; r < kLanesOf; r += kRows) transpose_blocks(v + r);
#pragma GCC unroll 16
    for (std::size_t r = 0; r < kRows; ++r) exchange_blocks<T>(v + r, kRows);
#pragma GCC unroll 16
    for (std::size_t r = 0; r < kLanesOf; ++r) store(v[r], to + (k + r) * kLanesOf);
  }
}
#endif

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
