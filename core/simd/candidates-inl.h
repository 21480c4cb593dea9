// The candidates of neighbouring queries: all points near them, in chunks that have boxes.
#if defined(PSS_CORE_SIMD_CANDIDATES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PSS_CORE_SIMD_CANDIDATES_INL_H_
#undef PSS_CORE_SIMD_CANDIDATES_INL_H_
#else
#define PSS_CORE_SIMD_CANDIDATES_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/simd/lanes-inl.h"
#include "core/simd/project.h"

HWY_BEFORE_NAMESPACE();
namespace pss::HWY_NAMESPACE {

/// The candidates of a run of neighbouring queries, in steps from the run's first position: exact
/// integers, in 32 bits where they fit and the run has no remainders, otherwise in doubles.
///
/// They lie in chunks of consecutive points, each with its box: a query looks at the chunks whose
/// box its ball may touch, whole vectors at a time.
class Candidates {
 public:
  Candidates(const simd::Batch& batch, simd::Workspace& workspace)
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

  std::size_t count() const { return count_; }
  std::size_t chunks() const { return chunks_; }
  /// Whether they are in Workspace::narrow, and nothing has a remainder, or in Workspace::wide.
  bool narrow() const { return narrow_; }
  const Lattice& lattice() const { return grid_.lattice(); }
  simd::Workspace& workspace() const { return w_; }

  /// A position as the candidates' are.
  Index3 relative(const Index3& position) const {
    return {position[0] - anchor_[0], position[1] - anchor_[1], position[2] - anchor_[2]};
  }

 private:
  static constexpr std::int64_t kMostSteps = std::int64_t{1} << 30;
  static constexpr std::size_t kChunk = simd::kChunk;

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
    const Index3 anchor = anchor_;
    std::uint64_t beyond = 0;
    std::size_t k = 0;
    for (const PointRange& range : w_.slice)
      for (std::size_t i = range.begin; i < range.end; ++i, ++k)
        for (std::size_t a = 0; a < 3; ++a) {
          const std::int64_t steps = points[i][a] - anchor[a];
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

  const simd::Batch& batch_;
  const CellGrid& grid_;
  simd::Workspace& w_;
  std::size_t count_ = 0;
  std::size_t chunks_ = 0;  // that hold them
  Index3 anchor_{};
  std::size_t next_ = 0;  // range that is not loaded whole
  bool fits_ = false;     // 32 bits hold the queries
  bool narrow_ = false;   // and the candidates
};

}  // namespace pss::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
