// Brings each query's candidates into its lane: exactly those within reach, in key order.
#if defined(PSS_CORE_SIMD_FILTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_FILTER_INL_H_
#undef PSS_CORE_SIMD_FILTER_INL_H_
#else
#define PSS_CORE_SIMD_FILTER_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "core/simd/row_end-inl.h"
#include "core/simd/touch-inl.h"
#include "core/simd/weight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Chunks that a query looks at.
template <class Begin>
using ChunkBegins = std::span<const Begin>;

/// The candidates of one slice, tried for one query after the other.
template <bool kNormals>
class Filter {
 public:
  explicit Filter(const Candidates& candidates)
      : candidates_(candidates),
        w_(candidates.workspace()),
        lattice_(candidates.lattice()),
        count_(candidates.count()) {}

  /// Appends those within reach of the query to its row, in units of h.
  template <class T>
  void add(const Seeker& seeker, simd::LaneRow<T>& row) const {
    const std::size_t before = row.count;
    if (candidates_.narrow())
      add_narrow(seeker, row);
    else
      add_wide(seeker, row);
    bring_near(seeker, before, row);
  }

 private:
  static constexpr std::size_t kChunk = simd::kChunk;

  // Chunks whose candidates a row has room for at once; between them it grows.
  static constexpr std::size_t kBlock = 32;
  static constexpr std::size_t kPadding = 16;

  template <class T>
  void add_narrow(const Seeker& seeker, simd::LaneRow<T>& row) const {
    auto* const begins = reinterpret_cast<std::int32_t*>(w_.touched.data());
    const std::size_t n = touch<float>(w_.narrow, candidates_.chunks(), lattice_, seeker, begins);
    in_blocks<std::int32_t>({begins, n}, row, [&](ChunkBegins<std::int32_t> block) {
      if constexpr (sizeof(T) == 4)
        add_singles(block, seeker, row);
      else
        add_doubles(w_.narrow, block, seeker, row);
    });
  }

  template <class T>
  void add_wide(const Seeker& seeker, simd::LaneRow<T>& row) const {
    std::int64_t* const begins = w_.touched.data();
    const std::size_t n = touch<double>(w_.wide, candidates_.chunks(), lattice_, seeker, begins);
    in_blocks<std::int64_t>({begins, n}, row, [&](ChunkBegins<std::int64_t> block) {
      if constexpr (sizeof(T) == 4)
        add_wide_singles(block, seeker, row);
      else
        add_doubles(w_.wide, block, seeker, row);
    });
  }

  template <class Begin, class T, class Add>
  static void in_blocks(ChunkBegins<Begin> begins, simd::LaneRow<T>& row, const Add& add) {
    for (std::size_t n = 0; n < begins.size(); n += kBlock) {
      const auto block = begins.subspan(n, std::min(kBlock, begins.size() - n));
      row.reserve(row.count, block.size() * kChunk + kPadding, kNormals);
      add(block);
    }
  }

  /// The exact decision for one candidate.
  bool inside(double dx, double dy, double dz, const Seeker& seeker) const {
    const World3& rest = seeker.query.remainder;
    return length_sq(lattice_.scale[0] * dx - rest[0], lattice_.scale[1] * dy - rest[1],
                     lattice_.scale[2] * dz - rest[2]) < seeker.reach_sq;
  }

  /// The lanes from candidate k on that are candidates and not padding.
  template <class D>
  hn::Mask<D> first(D d, std::size_t k) const {
    return hn::FirstN(d, k < count_ ? count_ - k : 0);
  }

  /// 32-bit steps to single coordinates: the decision in single too, except near the boundary.
  ///
  /// A loop that called something would keep all that it needs in memory, so one that meets doubts
  /// is done again.
  void add_singles(ChunkBegins<std::int32_t> begins, const Seeker& seeker,
                   simd::LaneRow<float>& row) const {
    const std::size_t before = row.count;
    if (HWY_LIKELY(!add_singles<false>(begins, seeker, row))) return;
    row.count = before;
    add_singles<true>(begins, seeker, row);
  }

  /// Returns whether some candidate was too near the boundary, which is then decided exactly or
  /// left out.
  template <bool kDecides>
  HWY_NOINLINE bool add_singles(ChunkBegins<std::int32_t> begins, const Seeker& seeker,
                                simd::LaneRow<float>& row) const {
    using V = Vec<float>;
    const Tag<float> d;
    const hn::RebindToSigned<Tag<float>> di;
    const auto qx = hn::Set(di, static_cast<std::int32_t>(seeker.position[0]));
    const auto qy = hn::Set(di, static_cast<std::int32_t>(seeker.position[1]));
    const auto qz = hn::Set(di, static_cast<std::int32_t>(seeker.position[2]));
    const V sx = set(static_cast<float>(lattice_.scale[0] * seeker.per_h));
    const V sy = set(static_cast<float>(lattice_.scale[1] * seeker.per_h));
    const V sz = set(static_cast<float>(lattice_.scale[2] * seeker.per_h));
    // Six roundings of 2^-24 each, twice, bound what single precision may get wrong.
    constexpr double kBand = 3e-6;
    const double limit = seeker.reach_sq * seeker.per_h * seeker.per_h;
    const V surely = set(static_cast<float>(limit * (1 - kBand)));
    const V perhaps = set(static_cast<float>(limit * (1 + kBand)));
    const std::int32_t* const px = w_.narrow.x.data();
    const std::int32_t* const py = w_.narrow.y.data();
    const std::int32_t* const pz = w_.narrow.z.data();
    const std::size_t count = count_;
    RowEnd<float, kNormals> end(row);
    auto doubts = none<float>();
    for (const std::int32_t chunk : begins) {
      const std::size_t begin = static_cast<std::size_t>(chunk);
      for (std::size_t k = begin; k < begin + kChunk; k += kLanes<float>) {
        const V x = hn::ConvertTo(d, hn::LoadU(di, px + k) - qx) * sx;
        const V y = hn::ConvertTo(d, hn::LoadU(di, py + k) - qy) * sy;
        const V z = hn::ConvertTo(d, hn::LoadU(di, pz + k) - qz) * sz;
        const V length = fma(x, x, fma(y, y, z * z));
        auto mask = length < surely;
        const auto maybe = length < perhaps;
        doubts = hn::Or(doubts, hn::AndNot(mask, maybe));
        if constexpr (kDecides) mask = decide(seeker, k, mask, maybe, length) < surely;
        if (HWY_UNLIKELY(count < k + kLanes<float>)) mask = hn::And(mask, first(d, k));
        end.add(d, mask, x, y, z);
        if constexpr (kNormals) add_normals(d, mask, k, end);
        end.keep(d, mask);
      }
    }
    return !hn::AllFalse(d, doubts);
  }

  /// Squared lengths with those that single precision cannot judge made 0 or infinite.
  HWY_NOINLINE Vec<float> decide(const Seeker& seeker, std::size_t k, Mask<float> sure,
                                 Mask<float> maybe, Vec<float> length) const {
    const Tag<float> d;
    alignas(64) float lengths[kLanes<float>], doubt[kLanes<float>];
    store(length, lengths);
    store(hn::IfThenElseZero(hn::AndNot(sure, maybe), set(1.0f)), doubt);
    const auto steps = [&](const simd::Buffer<std::int32_t>& from, std::size_t i, std::size_t a) {
      return static_cast<double>(from.data()[k + i] - seeker.position[a]);
    };
    for (std::size_t i = 0; i < kLanes<float>; ++i) {
      if (doubt[i] == 0) continue;
      const bool in = inside(steps(w_.narrow.x, i, 0), steps(w_.narrow.y, i, 1),
                             steps(w_.narrow.z, i, 2), seeker);
      lengths[i] = in ? 0.0f : std::numeric_limits<float>::infinity();
    }
    return hn::Load(d, lengths);
  }

  /// Steps of either type to double coordinates and the exact decision.
  template <class I, class Begin>
  HWY_NOINLINE void add_doubles(const simd::CandidateChunks<I>& chunks, ChunkBegins<Begin> begins,
                                const Seeker& seeker, simd::LaneRow<double>& row) const {
    using V = Vec<double>;
    const Tag<double> d;
    const World3& rest = seeker.query.remainder;
    const V qx = set(static_cast<double>(seeker.position[0]));
    const V qy = set(static_cast<double>(seeker.position[1]));
    const V qz = set(static_cast<double>(seeker.position[2]));
    const V sx = set(lattice_.scale[0]), sy = set(lattice_.scale[1]), sz = set(lattice_.scale[2]);
    const V rx = set(rest[0]), ry = set(rest[1]), rz = set(rest[2]);
    const V per_h = set(seeker.per_h);
    const V limit = set(seeker.reach_sq);
    const I* const px = chunks.x.data();
    const I* const py = chunks.y.data();
    const I* const pz = chunks.z.data();
    const std::size_t count = count_;
    RowEnd<double, kNormals> end(row);
    for (const auto chunk : begins) {
      const std::size_t begin = static_cast<std::size_t>(chunk);
      for (std::size_t k = begin; k < begin + kChunk; k += kLanes<double>) {
        const V x = sx * (doubles(px + k) - qx) - rx;
        const V y = sy * (doubles(py + k) - qy) - ry;
        const V z = sz * (doubles(pz + k) - qz) - rz;
        auto mask = fma(x, x, fma(y, y, z * z)) < limit;
        if (HWY_UNLIKELY(count < k + kLanes<double>)) mask = hn::And(mask, first(d, k));
        end.add(d, mask, x * per_h, y * per_h, z * per_h);
        if constexpr (kNormals) add_normals(d, mask, k, end);
        end.keep(d, mask);
      }
    }
  }

  HWY_INLINE static Vec<double> doubles(const double* from) {
    return hn::LoadU(Tag<double>(), from);
  }
  HWY_INLINE static Vec<double> doubles(const std::int32_t* from) {
    const hn::Rebind<std::int32_t, Tag<double>> half;
    return hn::PromoteTo(Tag<double>(), hn::LoadU(half, from));
  }
  HWY_INLINE static Vec<double> doubles(const float* from) {
    const hn::Rebind<float, Tag<double>> half;
    return hn::PromoteTo(Tag<double>(), hn::LoadU(half, from));
  }

  /// Wide steps to single coordinates: the same bits as of narrow ones where there is no remainder.
  HWY_NOINLINE void add_wide_singles(ChunkBegins<std::int64_t> begins, const Seeker& seeker,
                                     simd::LaneRow<float>& row) const {
    const Tag<double> d;
    const hn::Rebind<float, Tag<double>> half;
    const World3& rest = seeker.query.remainder;
    const auto limit = set(seeker.reach_sq);
    const double* const from[3] = {w_.wide.x.data(), w_.wide.y.data(), w_.wide.z.data()};
    const auto steps = [&](std::size_t axis, std::size_t k) {
      return hn::LoadU(d, from[axis] + k) - set(static_cast<double>(seeker.position[axis]));
    };
    const auto length = [&](std::size_t axis, Vec<double> dx) {
      return set(lattice_.scale[axis]) * dx - set(rest[axis]);
    };
    const auto local = [&](std::size_t axis, Vec<double> dx) {
      const auto scale = hn::Set(half, static_cast<float>(lattice_.scale[axis] * seeker.per_h));
      const auto cut = hn::Set(half, static_cast<float>(rest[axis] * seeker.per_h));
      return hn::DemoteTo(half, dx) * scale - cut;
    };
    const std::size_t count = count_;
    RowEnd<float, kNormals> end(row);
    for (const auto chunk : begins) {
      const std::size_t begin = static_cast<std::size_t>(chunk);
      for (std::size_t k = begin; k < begin + kChunk; k += kLanes<double>) {
        const auto dx = steps(0, k);
        const auto dy = steps(1, k);
        const auto dz = steps(2, k);
        const auto x = length(0, dx);
        const auto y = length(1, dy);
        const auto z = length(2, dz);
        auto mask = fma(x, x, fma(y, y, z * z)) < limit;
        if (HWY_UNLIKELY(count < k + kLanes<double>)) mask = hn::And(mask, first(d, k));
        // The mask of doubles as one of floats: 1 or 0, demoted.
        const auto keep = hn::DemoteTo(half, hn::IfThenElseZero(mask, set(1.0))) > hn::Zero(half);
        end.add(half, keep, local(0, dx), local(1, dy), local(2, dz));
        if constexpr (kNormals) add_normals(half, keep, k, end);
        end.keep(half, keep);
      }
    }
  }

  /// Adds the normals of the candidates from k on that the mask names.
  template <class D, class M, class T>
  HWY_INLINE void add_normals(D d, M mask, std::size_t k, RowEnd<T, kNormals>& end) const {
    const auto normal = [&](const simd::Buffer<float>& from) {
      if constexpr (sizeof(T) == 8)
        return doubles(from.data() + k);
      else
        return hn::LoadU(d, from.data() + k);
    };
    end.add_normals(d, mask, normal(w_.normal_x), normal(w_.normal_y), normal(w_.normal_z));
  }

  /// Coordinates beyond all weights, which only very wide supports have, stay finite in sums.
  template <class T>
  static void bring_near(const Seeker& seeker, std::size_t first, simd::LaneRow<T>& row) {
    if (seeker.reach_sq <= kFarAway * kFarAway * seeker.h * seeker.h) return;
    const T far = T(kFarAway);
    for (auto* buffer : {&row.x, &row.y, &row.z})
      for (std::size_t k = first; k < row.count; ++k)
        buffer->data()[k] = std::clamp(buffer->data()[k], -far, far);
  }

  const Candidates& candidates_;
  simd::Workspace& w_;
  const Lattice& lattice_;
  std::size_t count_;  // candidates
};

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
