// Brings each query's candidates into its lane: exactly those within reach, in key order.
#if defined(PSS_CORE_SIMD_GATHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_GATHER_INL_H_
#undef PSS_CORE_SIMD_GATHER_INL_H_
#else
#define PSS_CORE_SIMD_GATHER_INL_H_
#endif

#include <algorithm>
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
class RunCandidates {
 public:
  RunCandidates(const simd::Batch& batch, simd::Workspace& workspace)
      : batch_(batch), grid_(batch.grid), w_(workspace) {}

  /// Collects all points within `reach` of the box of the queries.
  void collect(const IndexBox& box, double reach, bool exact) {
    grid_.gather_ranges(box, reach, w_.ranges);
    count_ = 0;
    for (const PointRange& range : w_.ranges) count_ += range.end - range.begin;
    anchor_ = box.min;
    narrow_ = exact && fits(box);
    if (narrow_) narrow_ = copy(w_.narrow_x, w_.narrow_y, w_.narrow_z);
    if (!narrow_) copy(w_.wide_x, w_.wide_y, w_.wide_z);
    if (needs_normals(batch_.method.op)) copy_normals();
  }

  /// Appends what lies within reach of the query to an empty row, in units of h.
  template <class T>
  void filter(const Seeker& seeker, simd::LaneRow<T>& row) const {
    row.count = 0;
    if constexpr (sizeof(T) == 4) {
      if (narrow_) return filter_narrow(seeker, row);
      filter_wide(seeker, row);
    } else {
      narrow_
          ? filter_doubles(w_.narrow_x.data(), w_.narrow_y.data(), w_.narrow_z.data(), seeker, row)
          : filter_doubles(w_.wide_x.data(), w_.wide_y.data(), w_.wide_z.data(), seeker, row);
    }
  }

 private:
  static constexpr std::int64_t kMostSteps = std::int64_t{1} << 30;
  static constexpr std::size_t kPadding = 16;

  bool fits(const IndexBox& box) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (box.max[a] - box.min[a] >= kMostSteps) return false;
    return true;
  }

  /// Copies coordinates relative to the anchor; false where one does not fit the type.
  template <class I>
  bool copy(simd::Buffer<I>& x, simd::Buffer<I>& y, simd::Buffer<I>& z) {
    x.reserve(count_ + kPadding);
    y.reserve(count_ + kPadding);
    z.reserve(count_ + kPadding);
    I* const px = x.data();
    I* const py = y.data();
    I* const pz = z.data();
    const Index3* const points = grid_.points().data();
    const Index3 anchor = anchor_;
    std::uint64_t beyond = 0;
    std::size_t k = 0;
    for (const PointRange& range : w_.ranges)
      for (std::size_t i = range.begin; i < range.end; ++i, ++k) {
        const std::int64_t dx = points[i][0] - anchor[0];
        const std::int64_t dy = points[i][1] - anchor[1];
        const std::int64_t dz = points[i][2] - anchor[2];
        beyond |=
            static_cast<std::uint64_t>((dx + kMostSteps) | (dy + kMostSteps) | (dz + kMostSteps));
        px[k] = static_cast<I>(dx);
        py[k] = static_cast<I>(dy);
        pz[k] = static_cast<I>(dz);
      }
    std::fill_n(px + k, kPadding, I{0});
    std::fill_n(py + k, kPadding, I{0});
    std::fill_n(pz + k, kPadding, I{0});
    return beyond < static_cast<std::uint64_t>(2 * kMostSteps);
  }

  void copy_normals() {
    for (auto* buffer : {&w_.normal_x, &w_.normal_y, &w_.normal_z})
      buffer->reserve(count_ + kPadding);
    std::size_t k = 0;
    for (const PointRange& range : w_.ranges)
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

  template <class T>
  static void grow(simd::LaneRow<T>& row, std::size_t count) {
    for (auto* buffer : {&row.x, &row.y, &row.z}) buffer->reserve(count, row.count);
  }

  template <class T>
  static void grow_normals(simd::LaneRow<T>& row, std::size_t count) {
    for (auto* buffer : {&row.nx, &row.ny, &row.nz}) buffer->reserve(count, row.count);
  }

  /// Keeps the normals of the candidates from k on that the mask names.
  template <class D, class M>
  HWY_INLINE void keep_normals(D d, M mask, std::size_t k, simd::LaneRow<float>& row) const {
    grow_normals(row, row.count + kPadding);
    hn::StoreU(hn::Compress(hn::LoadU(d, w_.normal_x.data() + k), mask), d,
               row.nx.data() + row.count);
    hn::StoreU(hn::Compress(hn::LoadU(d, w_.normal_y.data() + k), mask), d,
               row.ny.data() + row.count);
    hn::StoreU(hn::Compress(hn::LoadU(d, w_.normal_z.data() + k), mask), d,
               row.nz.data() + row.count);
  }

  /// 32-bit steps to single coordinates: the decision in single too, except near the boundary.
  HWY_INLINE void filter_narrow(const Seeker& seeker, simd::LaneRow<float>& row) const {
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
    for (std::size_t k = 0; k < count_; k += kLanes<float>) {
      if (row.count + kLanes < float >> row.x.capacity()) grow(row, row.count + kLanes<float>);
      const V x = hn::ConvertTo(d, hn::LoadU(di, w_.narrow_x.data() + k) - qx) * sx;
      const V y = hn::ConvertTo(d, hn::LoadU(di, w_.narrow_y.data() + k) - qy) * sy;
      const V z = hn::ConvertTo(d, hn::LoadU(di, w_.narrow_z.data() + k) - qz) * sz;
      V length = fma(x, x, fma(y, y, z * z));
      auto mask = length < surely;
      const auto maybe = length < perhaps;
      if (HWY_UNLIKELY(hn::CountTrue(d, maybe) != hn::CountTrue(d, mask))) {
        length = decide(seeker, k, mask, maybe, length);
        mask = length < surely;
      }
      if (k + kLanes < float >> count_) mask = hn::And(mask, hn::FirstN(d, count_ - k));
      hn::StoreU(hn::Compress(x, mask), d, row.x.data() + row.count);
      hn::StoreU(hn::Compress(y, mask), d, row.y.data() + row.count);
      hn::StoreU(hn::Compress(z, mask), d, row.z.data() + row.count);
      if (normals) keep_normals(d, mask, k, row);
      row.count += hn::CountTrue(d, mask);
    }
    bring_near(seeker, row);
  }

  /// Squared lengths with those that single precision cannot judge made 0 or infinite.
  HWY_NOINLINE Vec<float> decide(const Seeker& seeker, std::size_t k, Mask<float> sure,
                                 Mask<float> maybe, Vec<float> length) const {
    const Tag<float> d;
    alignas(64) float lengths[kLanes<float>], doubt[kLanes<float>];
    store(length, lengths);
    store(hn::IfThenElseZero(hn::AndNot(sure, maybe), set(1.0f)), doubt);
    for (std::size_t i = 0; i < kLanes<float>; ++i) {
      if (doubt[i] == 0) continue;
      const auto dx = static_cast<double>(w_.narrow_x.data()[k + i] - relative(seeker, 0));
      const auto dy = static_cast<double>(w_.narrow_y.data()[k + i] - relative(seeker, 1));
      const auto dz = static_cast<double>(w_.narrow_z.data()[k + i] - relative(seeker, 2));
      lengths[i] = inside(dx, dy, dz, seeker) ? 0.0f : std::numeric_limits<float>::infinity();
    }
    return hn::Load(d, lengths);
  }

  /// Steps of either type to double coordinates and the exact decision.
  template <class I>
  HWY_INLINE void filter_doubles(const I* px, const I* py, const I* pz, const Seeker& seeker,
                                 simd::LaneRow<double>& row) const {
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
    for (std::size_t k = 0; k < count_; k += kLanes<double>) {
      if (row.count + kLanes < double >> row.x.capacity()) grow(row, row.count + kLanes<double>);
      const V x = sx * (doubles(px + k) - qx) - rx;
      const V y = sy * (doubles(py + k) - qy) - ry;
      const V z = sz * (doubles(pz + k) - qz) - rz;
      auto mask = fma(x, x, fma(y, y, z * z)) < limit;
      if (k + kLanes < double >> count_) mask = hn::And(mask, hn::FirstN(d, count_ - k));
      hn::StoreU(hn::Compress(x * per_h, mask), d, row.x.data() + row.count);
      hn::StoreU(hn::Compress(y * per_h, mask), d, row.y.data() + row.count);
      hn::StoreU(hn::Compress(z * per_h, mask), d, row.z.data() + row.count);
      if (normals) keep_normals(mask, k, row);
      row.count += hn::CountTrue(d, mask);
    }
    bring_near(seeker, row);
  }

  HWY_INLINE static Vec<double> doubles(const double* from) {
    return hn::LoadU(Tag<double>(), from);
  }
  HWY_INLINE static Vec<double> doubles(const std::int32_t* from) {
    const hn::Rebind<std::int32_t, Tag<double>> half;
    return hn::PromoteTo(Tag<double>(), hn::LoadU(half, from));
  }

  void keep_normals(Mask<double> mask, std::size_t k, simd::LaneRow<double>& row) const {
    grow_normals(row, row.count + kPadding);
    const Tag<double> d;
    const hn::Rebind<float, Tag<double>> half;
    const auto keep = [&](const float* from, double* to) {
      hn::StoreU(hn::Compress(hn::PromoteTo(d, hn::LoadU(half, from)), mask), d, to);
    };
    keep(w_.normal_x.data() + k, row.nx.data() + row.count);
    keep(w_.normal_y.data() + k, row.ny.data() + row.count);
    keep(w_.normal_z.data() + k, row.nz.data() + row.count);
  }

  /// Wide steps to single coordinates: the same bits as filter_narrow where there is no remainder.
  HWY_INLINE void filter_wide(const Seeker& seeker, simd::LaneRow<float>& row) const {
    const Tag<double> d;
    const hn::Rebind<float, Tag<double>> half;
    const Lattice& lattice = grid_.lattice();
    const World3& rest = seeker.query.remainder;
    const double per_h = 1 / seeker.h;
    const bool normals = needs_normals(batch_.method.op);
    const auto limit = set(seeker.reach_sq);
    const double* const from[3] = {w_.wide_x.data(), w_.wide_y.data(), w_.wide_z.data()};
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
    for (std::size_t k = 0; k < count_; k += kLanes<double>) {
      if (row.count + kLanes < double >> row.x.capacity()) grow(row, row.count + kLanes<double>);
      const auto dx = steps(0, k);
      const auto dy = steps(1, k);
      const auto dz = steps(2, k);
      const auto x = length(0, dx);
      const auto y = length(1, dy);
      const auto z = length(2, dz);
      auto mask = fma(x, x, fma(y, y, z * z)) < limit;
      if (k + kLanes < double >> count_) mask = hn::And(mask, hn::FirstN(d, count_ - k));
      // The mask of doubles as one of floats: 1 or 0, demoted.
      const auto keep = hn::DemoteTo(half, hn::IfThenElseZero(mask, set(1.0))) > hn::Zero(half);
      hn::StoreU(hn::Compress(local(0, dx), keep), half, row.x.data() + row.count);
      hn::StoreU(hn::Compress(local(1, dy), keep), half, row.y.data() + row.count);
      hn::StoreU(hn::Compress(local(2, dz), keep), half, row.z.data() + row.count);
      if (normals) keep_normals(half, keep, k, row);
      row.count += hn::CountTrue(d, mask);
    }
    bring_near(seeker, row);
  }

  /// Coordinates beyond all weights, which only very wide supports have, stay finite in sums.
  template <class T>
  static void bring_near(const Seeker& seeker, simd::LaneRow<T>& row) {
    if (seeker.reach_sq <= kFarAway * kFarAway * seeker.h * seeker.h) return;
    const T far = T(kFarAway);
    for (auto* buffer : {&row.x, &row.y, &row.z})
      for (std::size_t k = 0; k < row.count; ++k)
        buffer->data()[k] = std::clamp(buffer->data()[k], -far, far);
  }

  const simd::Batch& batch_;
  const CellGrid& grid_;
  simd::Workspace& w_;
  std::size_t count_ = 0;
  Index3 anchor_{};
  bool narrow_ = false;
};

/// Copies a row into its lane of [k][lane], and fills up the rest of the lane.
template <class T>
HWY_INLINE void transpose(const T* row, std::size_t count, std::size_t lane, std::size_t steps,
                          T padding, T* to) {
  to += lane;
  for (std::size_t k = 0; k < count; ++k) to[k * kLanes<T>] = row[k];
  for (std::size_t k = count; k < steps; ++k) to[k * kLanes<T>] = padding;
}

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
