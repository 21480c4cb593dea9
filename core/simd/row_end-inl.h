// Where the neighbours of a query are put one after the other.
#if defined(PSS_CORE_SIMD_ROW_END_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_ROW_END_INL_H_
#undef PSS_CORE_SIMD_ROW_END_INL_H_
#else
#define PSS_CORE_SIMD_ROW_END_INL_H_
#endif

#include "core/simd/compress-inl.h"
#include "core/simd/project.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// Where a row's next neighbours go, with room for them.
template <class T, bool kNormals>
class RowEnd {
 public:
  explicit RowEnd(simd::LaneRow<T>& row)
      : row_(row),
        x_(row.x.data()),
        y_(row.y.data()),
        z_(row.z.data()),
        nx_(row.nx.data()),
        ny_(row.ny.data()),
        nz_(row.nz.data()),
        count_(row.count) {}
  ~RowEnd() { row_.count = count_; }
  RowEnd(const RowEnd&) = delete;
  RowEnd& operator=(const RowEnd&) = delete;

  template <class D, class M>
  HWY_INLINE void add(D d, M mask, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
    hn::StoreU(compress(x, mask), d, x_ + count_);
    hn::StoreU(compress(y, mask), d, y_ + count_);
    hn::StoreU(compress(z, mask), d, z_ + count_);
  }
  template <class D, class M>
  HWY_INLINE void add_normals(D d, M mask, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
    hn::StoreU(compress(x, mask), d, nx_ + count_);
    hn::StoreU(compress(y, mask), d, ny_ + count_);
    hn::StoreU(compress(z, mask), d, nz_ + count_);
  }
  /// Moves on behind what was added with the mask.
  template <class D, class M>
  HWY_INLINE void keep(D d, M mask) {
    count_ += hn::CountTrue(d, mask);
  }

 private:
  simd::LaneRow<T>& row_;
  T* x_;
  T* y_;
  T* z_;
  T* nx_;
  T* ny_;
  T* nz_;
  std::size_t count_;
};

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
