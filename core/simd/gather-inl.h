// Brings each query's candidates into its lane: exactly those within reach, in key order.
#if defined(PSS_CORE_SIMD_GATHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_GATHER_INL_H_
#undef PSS_CORE_SIMD_GATHER_INL_H_
#else
#define PSS_CORE_SIMD_GATHER_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "core/simd/plane-inl.h"
#include "core/simd/project.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// One query as the filter sees it.
struct Seeker {
  const Query& query;
  double h;
  double reach_sq;
};

/// The candidates of a run of neighbouring queries, in steps from the run's first position: exact
/// integers, in 32 bits where they fit and the run has no remainders, otherwise in doubles.
///
/// They lie in chunks of consecutive points, each with its box: a query looks at the chunks whose
/// box its ball may touch, whole vectors at a time.
class RunCandidates {
 public:
  RunCandidates(const simd::Batch& batch, simd::Workspace& workspace)
      : batch_(batch), grid_(batch.grid), w_(workspace) {}

  /// Finds all points within `reach` of the box of the queries; returns how many.
  std::size_t find(const IndexBox& box, double reach, bool exact) {
    grid_.gather_ranges(box, reach, w_.ranges);
    std::size_t total = 0;
    for (const PointRange& range : w_.ranges) total += range.end - range.begin;
    anchor_ = box.min;
    fits_ = exact && fits(box);
    next_ = 0;
    return total;
  }

  /// Loads the next of them, at most kMostCandidates; false where none are left.
  bool load() {
    take_slice();
    if (count_ == 0) return false;
    chunks_ = (count_ + kChunk - 1) / kChunk;
    narrow_ = fits_ && copy(w_.narrow);
    if (!narrow_) copy(w_.wide);
    if (needs_normals(batch_.method.op)) copy_normals();
    w_.touched.reserve(chunks_ + kChunk);
    return true;
  }

  /// Appends those within reach of the query to its row, in units of h.
  template <class T>
  void filter(const Seeker& seeker, simd::LaneRow<T>& row) const {
    const std::size_t before = row.count;
    const std::size_t touched =
        narrow_ ? touch<float>(w_.narrow, seeker) : touch<double>(w_.wide, seeker);
    if constexpr (sizeof(T) == 8) {
      narrow_ ? filter_doubles(w_.narrow, touched, seeker, row)
              : filter_doubles(w_.wide, touched, seeker, row);
    } else {
      narrow_ ? filter_narrow(touched, seeker, row) : filter_wide(touched, seeker, row);
    }
    bring_near(seeker, before, row);
  }

 private:
  static constexpr std::int64_t kMostSteps = std::int64_t{1} << 30;
  static constexpr std::size_t kChunk = simd::kChunk;
  static constexpr std::size_t kPadding = 16;

  static bool fits(const IndexBox& box) {
    for (std::size_t a = 0; a < 3; ++a)
      if (box.max[a] - box.min[a] >= kMostSteps) return false;
    return true;
  }

  /// Moves the next kMostCandidates of the ranges, or what is left, to the slice.
  void take_slice() {
    w_.slice.clear();
    count_ = 0;
    for (; next_ < w_.ranges.size() && count_ < simd::kMostCandidates; ++next_) {
      PointRange& range = w_.ranges[next_];
      const std::size_t end = std::min(range.end, range.begin + simd::kMostCandidates - count_);
      w_.slice.push_back({range.begin, end});
      count_ += end - range.begin;
      range.begin = end;
      if (range.begin < range.end) break;
    }
  }

  /// Copies coordinates relative to the anchor; false where one does not fit the type.
  template <class I>
  bool copy(simd::CandidateChunks<I>& to) {
    to.reserve(chunks_);
    std::array<I*, 3> out{to.x.data(), to.y.data(), to.z.data()};
    const Index3* const points = grid_.points().data();
    std::uint64_t beyond = 0;
    std::size_t k = 0;
    for (const PointRange& range : w_.slice)
      for (std::size_t i = range.begin; i < range.end; ++i, ++k)
        for (std::size_t a = 0; a < 3; ++a) {
          const std::int64_t steps = points[i][a] - anchor_[a];
          beyond |= static_cast<std::uint64_t>(steps + kMostSteps);
          out[a][k] = static_cast<I>(steps);
        }
    // The last chunk is filled up with its last point, whose copies a mask leaves out.
    for (; k > 0 && k < chunks_ * kChunk; ++k)
      for (std::size_t a = 0; a < 3; ++a) out[a][k] = out[a][k - 1];
    for (std::size_t a = 0; a < 3; ++a) bound(out[a], to.low[a].data(), to.high[a].data());
    return beyond < static_cast<std::uint64_t>(2 * kMostSteps);
  }

  /// The least and the greatest of each chunk.
  template <class I>
  void bound(const I* values, I* low, I* high) const {
    for (std::size_t c = 0; c < chunks_; ++c, values += kChunk) {
      I least = values[0], most = values[0];
      for (std::size_t i = 1; i < kChunk; ++i) {
        least = values[i] < least ? values[i] : least;
        most = values[i] > most ? values[i] : most;
      }
      low[c] = least;
      high[c] = most;
    }
  }

  /// Lists the chunks whose box the query's ball may touch; returns how many.
  ///
  /// In T, with room for its rounding: what is decided here only saves work.
  template <class T, class I>
  HWY_INLINE std::size_t touch(const simd::CandidateChunks<I>& chunks, const Seeker& seeker) const {
    const Tag<T> d;
    const hn::Rebind<I, Tag<T>> di;
    const hn::RebindToSigned<Tag<T>> index;
    using Id = hn::TFromD<decltype(index)>;
    const Lattice& lattice = grid_.lattice();
    const World3& rest = seeker.query.remainder;
    const Vec<T> zero = set(T{0});
    const double per_h = 1 / seeker.h;
    const Vec<T> limit = set(static_cast<T>(seeker.reach_sq * per_h * per_h * (1 + 1e-5)));
    Id* const out = reinterpret_cast<Id*>(w_.touched.data());
    std::size_t count = 0;
    for (std::size_t c = 0; c < chunks_; c += kLanes<T>) {
      Vec<T> sum = zero;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto q = hn::Set(di, static_cast<I>(relative(seeker, a)));
        const auto below = hn::LoadU(di, chunks.low[a].data() + c) - q;
        const auto above = q - hn::LoadU(di, chunks.high[a].data() + c);
        const auto gap = as<T>(hn::Max(below, above));
        const Vec<T> scale = set(static_cast<T>(lattice.scale[a] * per_h));
        const Vec<T> slack = set(static_cast<T>(std::abs(rest[a]) * per_h));
        const Vec<T> distance = hn::Max(gap * scale - slack, zero);
        sum = fma(distance, distance, sum);
      }
      auto mask = sum <= limit;
      if (chunks_ < c + kLanes<T>) mask = hn::And(mask, hn::FirstN(d, chunks_ - c));
      const auto ids = hn::Iota(index, static_cast<Id>(c));
      hn::StoreU(compress(ids, hn::RebindMask(index, mask)), index, out + count);
      count += hn::CountTrue(d, mask);
    }
    return count;
  }

  template <class T>
  HWY_INLINE static Vec<T> as(Vec<T> v) {
    return v;
  }
  template <class T>
  HWY_INLINE static Vec<T> as(hn::Vec<hn::Rebind<std::int32_t, Tag<float>>> v) {
    return hn::ConvertTo(Tag<T>(), v);
  }

  /// Where the n-th touched chunk begins among the candidates.
  template <class Id>
  std::size_t chunk_begin(std::size_t n) const {
    return static_cast<std::size_t>(reinterpret_cast<const Id*>(w_.touched.data())[n]) * kChunk;
  }
  std::size_t chunk_begin(std::size_t n) const {
    return narrow_ ? chunk_begin<std::int32_t>(n) : chunk_begin<std::int64_t>(n);
  }

  void copy_normals() {
    for (auto* buffer : {&w_.normal_x, &w_.normal_y, &w_.normal_z})
      buffer->reserve(chunks_ * kChunk);
    std::size_t k = 0;
    for (const PointRange& range : w_.slice)
      for (std::size_t i = range.begin; i < range.end; ++i, ++k) {
        const Normal& n = batch_.normals.values[i];
        w_.normal_x.data()[k] = n[0];
        w_.normal_y.data()[k] = n[1];
        w_.normal_z.data()[k] = n[2];
      }
  }

  /// The exact decision for one candidate.
  bool inside(double dx, double dy, double dz, const Seeker& seeker) const {
    const Lattice& lattice = grid_.lattice();
    const World3& rest = seeker.query.remainder;
    return length_sq(lattice.scale[0] * dx - rest[0], lattice.scale[1] * dy - rest[1],
                     lattice.scale[2] * dz - rest[2]) < seeker.reach_sq;
  }

  std::int64_t relative(const Seeker& seeker, std::size_t axis) const {
    return seeker.query.position[axis] - anchor_[axis];
  }

  /// Keeps the normals of the candidates from k on that the mask names.
  template <class D, class M>
  HWY_INLINE void keep_normals(D d, M mask, std::size_t k, std::size_t count,
                               simd::LaneRow<float>& row) const {
    hn::StoreU(compress(hn::LoadU(d, w_.normal_x.data() + k), mask), d, row.nx.data() + count);
    hn::StoreU(compress(hn::LoadU(d, w_.normal_y.data() + k), mask), d, row.ny.data() + count);
    hn::StoreU(compress(hn::LoadU(d, w_.normal_z.data() + k), mask), d, row.nz.data() + count);
  }

  /// 32-bit steps to single coordinates: the decision in single too, except near the boundary.
  HWY_INLINE void filter_narrow(std::size_t touched, const Seeker& seeker,
                                simd::LaneRow<float>& row) const {
    using V = Vec<float>;
    const Tag<float> d;
    const hn::RebindToSigned<Tag<float>> di;
    const Lattice& lattice = grid_.lattice();
    const auto qx = hn::Set(di, static_cast<std::int32_t>(relative(seeker, 0)));
    const auto qy = hn::Set(di, static_cast<std::int32_t>(relative(seeker, 1)));
    const auto qz = hn::Set(di, static_cast<std::int32_t>(relative(seeker, 2)));
    const double per_h = 1 / seeker.h;
    const V sx = set(static_cast<float>(lattice.scale[0] * per_h));
    const V sy = set(static_cast<float>(lattice.scale[1] * per_h));
    const V sz = set(static_cast<float>(lattice.scale[2] * per_h));
    // Six roundings of 2^-24 each, twice, bound what single precision may get wrong.
    constexpr double kBand = 3e-6;
    const double limit = seeker.reach_sq * per_h * per_h;
    const V surely = set(static_cast<float>(limit * (1 - kBand)));
    const V perhaps = set(static_cast<float>(limit * (1 + kBand)));
    const bool normals = needs_normals(batch_.method.op);
    const std::int32_t* const px = w_.narrow.x.data();
    const std::int32_t* const py = w_.narrow.y.data();
    const std::int32_t* const pz = w_.narrow.z.data();
    std::size_t count = row.count;
    for (std::size_t n = 0; n < touched; ++n) {
      const std::size_t begin = chunk_begin<std::int32_t>(n);
      row.reserve(count, kChunk + kPadding, normals);
      for (std::size_t k = begin; k < begin + kChunk; k += kLanes<float>) {
        const V x = hn::ConvertTo(d, hn::LoadU(di, px + k) - qx) * sx;
        const V y = hn::ConvertTo(d, hn::LoadU(di, py + k) - qy) * sy;
        const V z = hn::ConvertTo(d, hn::LoadU(di, pz + k) - qz) * sz;
        V length = fma(x, x, fma(y, y, z * z));
        auto mask = length < surely;
        const auto maybe = length < perhaps;
        if (HWY_UNLIKELY(!hn::AllFalse(d, hn::AndNot(mask, maybe)))) {
          length = decide(seeker, k, mask, maybe, length);
          mask = length < surely;
        }
        if (HWY_UNLIKELY(k + kLanes < float >> count_)) mask = hn::And(mask, first(d, k));
        hn::StoreU(compress(x, mask), d, row.x.data() + count);
        hn::StoreU(compress(y, mask), d, row.y.data() + count);
        hn::StoreU(compress(z, mask), d, row.z.data() + count);
        if (normals) keep_normals(d, mask, k, count, row);
        count += hn::CountTrue(d, mask);
      }
    }
    row.count = count;
  }

  /// The lanes from candidate k on that are candidates and not padding.
  template <class D>
  hn::Mask<D> first(D d, std::size_t k) const {
    return hn::FirstN(d, k < count_ ? count_ - k : 0);
  }

  /// Squared lengths with those that single precision cannot judge made 0 or infinite.
  HWY_NOINLINE Vec<float> decide(const Seeker& seeker, std::size_t k, Mask<float> sure,
                                 Mask<float> maybe, Vec<float> length) const {
    const Tag<float> d;
    alignas(64) float lengths[kLanes<float>], doubt[kLanes<float>];
    store(length, lengths);
    store(hn::IfThenElseZero(hn::AndNot(sure, maybe), set(1.0f)), doubt);
    const auto steps = [&](const simd::Buffer<std::int32_t>& from, std::size_t i, std::size_t a) {
      return static_cast<double>(from.data()[k + i] - relative(seeker, a));
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
  template <class I>
  HWY_INLINE void filter_doubles(const simd::CandidateChunks<I>& chunks, std::size_t touched,
                                 const Seeker& seeker, simd::LaneRow<double>& row) const {
    using V = Vec<double>;
    const Tag<double> d;
    const Lattice& lattice = grid_.lattice();
    const World3& rest = seeker.query.remainder;
    const V qx = set(static_cast<double>(relative(seeker, 0)));
    const V qy = set(static_cast<double>(relative(seeker, 1)));
    const V qz = set(static_cast<double>(relative(seeker, 2)));
    const V sx = set(lattice.scale[0]), sy = set(lattice.scale[1]), sz = set(lattice.scale[2]);
    const V rx = set(rest[0]), ry = set(rest[1]), rz = set(rest[2]);
    const V per_h = set(1 / seeker.h);
    const V limit = set(seeker.reach_sq);
    const bool normals = needs_normals(batch_.method.op);
    std::size_t count = row.count;
    for (std::size_t n = 0; n < touched; ++n) {
      const std::size_t begin = chunk_begin(n);
      row.reserve(count, kChunk + kPadding, normals);
      for (std::size_t k = begin; k < begin + kChunk; k += kLanes<double>) {
        const V x = sx * (doubles(chunks.x.data() + k) - qx) - rx;
        const V y = sy * (doubles(chunks.y.data() + k) - qy) - ry;
        const V z = sz * (doubles(chunks.z.data() + k) - qz) - rz;
        auto mask = fma(x, x, fma(y, y, z * z)) < limit;
        if (HWY_UNLIKELY(k + kLanes < double >> count_)) mask = hn::And(mask, first(d, k));
        hn::StoreU(compress(x * per_h, mask), d, row.x.data() + count);
        hn::StoreU(compress(y * per_h, mask), d, row.y.data() + count);
        hn::StoreU(compress(z * per_h, mask), d, row.z.data() + count);
        if (normals) keep_normals(mask, k, count, row);
        count += hn::CountTrue(d, mask);
      }
    }
    row.count = count;
  }

  HWY_INLINE static Vec<double> doubles(const double* from) {
    return hn::LoadU(Tag<double>(), from);
  }
  HWY_INLINE static Vec<double> doubles(const std::int32_t* from) {
    const hn::Rebind<std::int32_t, Tag<double>> half;
    return hn::PromoteTo(Tag<double>(), hn::LoadU(half, from));
  }

  void keep_normals(Mask<double> mask, std::size_t k, std::size_t count,
                    simd::LaneRow<double>& row) const {
    const Tag<double> d;
    const hn::Rebind<float, Tag<double>> half;
    const auto keep = [&](const float* from, double* to) {
      hn::StoreU(compress(hn::PromoteTo(d, hn::LoadU(half, from)), mask), d, to);
    };
    keep(w_.normal_x.data() + k, row.nx.data() + count);
    keep(w_.normal_y.data() + k, row.ny.data() + count);
    keep(w_.normal_z.data() + k, row.nz.data() + count);
  }

  /// Wide steps to single coordinates: the same bits as filter_narrow where there is no remainder.
  HWY_INLINE void filter_wide(std::size_t touched, const Seeker& seeker,
                              simd::LaneRow<float>& row) const {
    const Tag<double> d;
    const hn::Rebind<float, Tag<double>> half;
    const Lattice& lattice = grid_.lattice();
    const World3& rest = seeker.query.remainder;
    const double per_h = 1 / seeker.h;
    const bool normals = needs_normals(batch_.method.op);
    const auto limit = set(seeker.reach_sq);
    const double* const from[3] = {w_.wide.x.data(), w_.wide.y.data(), w_.wide.z.data()};
    const auto steps = [&](std::size_t axis, std::size_t k) {
      return hn::LoadU(d, from[axis] + k) - set(static_cast<double>(relative(seeker, axis)));
    };
    const auto length = [&](std::size_t axis, Vec<double> dx) {
      return set(lattice.scale[axis]) * dx - set(rest[axis]);
    };
    const auto local = [&](std::size_t axis, Vec<double> dx) {
      const auto scale = hn::Set(half, static_cast<float>(lattice.scale[axis] * per_h));
      const auto cut = hn::Set(half, static_cast<float>(rest[axis] * per_h));
      return hn::DemoteTo(half, dx) * scale - cut;
    };
    std::size_t count = row.count;
    for (std::size_t n = 0; n < touched; ++n) {
      const std::size_t begin = chunk_begin<std::int64_t>(n);
      row.reserve(count, kChunk + kPadding, normals);
      for (std::size_t k = begin; k < begin + kChunk; k += kLanes<double>) {
        const auto dx = steps(0, k);
        const auto dy = steps(1, k);
        const auto dz = steps(2, k);
        const auto x = length(0, dx);
        const auto y = length(1, dy);
        const auto z = length(2, dz);
        auto mask = fma(x, x, fma(y, y, z * z)) < limit;
        if (HWY_UNLIKELY(k + kLanes < double >> count_)) mask = hn::And(mask, first(d, k));
        // The mask of doubles as one of floats: 1 or 0, demoted.
        const auto keep = hn::DemoteTo(half, hn::IfThenElseZero(mask, set(1.0))) > hn::Zero(half);
        hn::StoreU(compress(local(0, dx), keep), half, row.x.data() + count);
        hn::StoreU(compress(local(1, dy), keep), half, row.y.data() + count);
        hn::StoreU(compress(local(2, dz), keep), half, row.z.data() + count);
        if (normals) keep_normals(half, keep, k, count, row);
        count += hn::CountTrue(d, mask);
      }
    }
    row.count = count;
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

  const simd::Batch& batch_;
  const CellGrid& grid_;
  simd::Workspace& w_;
  std::size_t count_ = 0;   // candidates
  std::size_t chunks_ = 0;  // that hold them
  Index3 anchor_{};
  std::size_t next_ = 0;  // range that is not loaded whole
  bool fits_ = false;     // 32 bits hold the queries
  bool narrow_ = false;   // and the candidates
};

#if HWY_TARGET == HWY_SCALAR
template <class T>
inline constexpr std::size_t kBlockLanes = 1;

template <class T>
HWY_INLINE void transpose(const T* const* rows, std::size_t steps, T* to) {
  std::copy_n(rows[0], steps, to);
}
#else
/// Lanes whose rows are transposed together: as many as a 128-bit block holds.
template <class T>
inline constexpr std::size_t kBlockLanes = 16 / sizeof(T);

/// Within each 128-bit block, makes columns of the rows that the vectors hold.
HWY_INLINE void transpose_blocks(Vec<float>* v) {
  const Tag<float> d;
  const hn::RepartitionToWide<Tag<float>> pairs;
  const auto a = hn::BitCast(pairs, hn::InterleaveLower(d, v[0], v[1]));
  const auto b = hn::BitCast(pairs, hn::InterleaveUpper(d, v[0], v[1]));
  const auto c = hn::BitCast(pairs, hn::InterleaveLower(d, v[2], v[3]));
  const auto e = hn::BitCast(pairs, hn::InterleaveUpper(d, v[2], v[3]));
  v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, a, c));
  v[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, a, c));
  v[2] = hn::BitCast(d, hn::InterleaveLower(pairs, b, e));
  v[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, b, e));
}
HWY_INLINE void transpose_blocks(Vec<double>* v) {
  const Tag<double> d;
  const auto a = hn::InterleaveLower(d, v[0], v[1]);
  v[1] = hn::InterleaveUpper(d, v[0], v[1]);
  v[0] = a;
}

/// Copies kBlockLanes rows, padded to a whole number of vectors, into their lanes of [k][lane].
template <class T>
HWY_INLINE void transpose(const T* const* rows, std::size_t steps, T* to) {
  constexpr std::size_t kRows = kBlockLanes<T>;
  const hn::Simd<T, kRows, 0> block;
  alignas(64) T columns[kRows * kLanes<T>];
  for (std::size_t k = 0; k < steps; k += kLanes<T>) {
    Vec<T> v[kRows];
    for (std::size_t r = 0; r < kRows; ++r) v[r] = load(rows[r] + k);
    transpose_blocks(v);
    for (std::size_t r = 0; r < kRows; ++r) store(v[r], columns + r * kLanes<T>);
    // Vector r holds step r of every kRows steps.
    for (std::size_t b = 0; b < kLanes<T>; b += kRows)
      for (std::size_t r = 0; r < kRows; ++r)
        hn::Store(hn::Load(block, columns + r * kLanes<T> + b), block,
                  to + (k + b + r) * kLanes<T>);
  }
}
#endif

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
