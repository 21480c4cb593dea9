// Moves the lanes that a mask names together at the front.
#if defined(PSS_CORE_SIMD_COMPRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_COMPRESS_INL_H_
#undef PSS_CORE_SIMD_COMPRESS_INL_H_
#else
#define PSS_CORE_SIMD_COMPRESS_INL_H_
#endif

#include <cstdint>

#include "core/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

// Where Highway 1.0 looks lanes up in a table, g++ copies the whole table to the stack at each
// call: 64-bit lanes of AVX-512, and all of AVX2.
#if HWY_TARGET == HWY_AVX3
template <class V, class M>
HWY_INLINE V compress(V v, M mask) {
  using D = hn::DFromV<V>;
  if constexpr (sizeof(hn::TFromV<V>) == 8 && hn::MaxLanes(D()) == 8) {
    const hn::Repartition<double, D> d;
    return hn::BitCast(
        D(), hn::Vec<decltype(d)>{_mm512_maskz_compress_pd(mask.raw, hn::BitCast(d, v).raw)});
  } else {
    return hn::Compress(v, mask);
  }
}
#elif HWY_TARGET == HWY_AVX2
/// For each set of eight 32-bit lanes, those in it, then lane 0.
struct Packing {
  alignas(64) std::uint8_t lanes[256][8];
};

constexpr Packing packing() {
  Packing p{};
  for (unsigned set = 0; set < 256; ++set) {
    unsigned count = 0;
    for (unsigned lane = 0; lane < 8; ++lane)
      if (set >> lane & 1) p.lanes[set][count++] = static_cast<std::uint8_t>(lane);
  }
  return p;
}

inline constexpr Packing kPacking = packing();
/// The pairs of 32-bit lanes that four 64-bit lanes are.
inline constexpr std::uint8_t kPairs[16] = {0x00, 0x03, 0x0c, 0x0f, 0x30, 0x33, 0x3c, 0x3f,
                                            0xc0, 0xc3, 0xcc, 0xcf, 0xf0, 0xf3, 0xfc, 0xff};

template <class V, class M>
HWY_INLINE V compress(V v, M mask) {
  using D = hn::DFromV<V>;
  if constexpr (sizeof(V) == 32) {
    const Tag<std::uint32_t> words;
    const hn::Rebind<std::uint8_t, Tag<std::uint32_t> > bytes;
    std::uint8_t bits[8];
    hn::StoreMaskBits(D(), mask, bits);
    const std::size_t set = sizeof(hn::TFromV<V>) == 4 ? bits[0] : kPairs[bits[0]];
    const auto lanes = hn::PromoteTo(words, hn::Load(bytes, kPacking.lanes[set]));
    return hn::BitCast(
        D(), hn::TableLookupLanes(hn::BitCast(words, v), hn::IndicesFromVec(words, lanes)));
  } else {
    return hn::Compress(v, mask);
  }
}
#else
template <class V, class M>
HWY_INLINE V compress(V v, M mask) {
  return hn::Compress(v, mask);
}
#endif

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
