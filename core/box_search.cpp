// Which ranges of a cell grid's points a box touches, found for many balls at once.

#include <algorithm>
#include <array>

#include "core/touched_cells.h"

namespace pss {

/// A walk down the octree of cells, and within dense cells on down among the points.
class CellGrid::BoxSearch {
 public:
  BoxSearch(const CellGrid& grid, const IndexBox& box, double radius, std::vector<PointRange>& out)
      : grid_(grid),
        radius_(radius),
        longest_step_(std::ranges::max(grid.lattice_.scale)),
        out_(out) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t steps = steps_within(radius_, grid_.lattice_.scale[a]);
      low_[a] = std::max(box.min[a] - steps, kLatticeMin);
      high_[a] = std::min(box.max[a] + steps, kLatticeMax);
      const std::uint64_t first = biased(low_[a]) >> grid_.shift_;
      const std::uint64_t more = (biased(high_[a]) >> grid_.shift_) - first;
      first_cell_[a] = static_cast<std::uint32_t>(first) & CellPlace::kMask;
      more_cells_[a] = static_cast<std::uint32_t>(std::min<std::uint64_t>(more, CellPlace::kMask));
    }
  }

  /// Starts from the cells of which the box touches two along each axis at most: from further up,
  /// most of the walk would be the way down to them.
  void run() {
    int shift = grid_.shift_;
    for (std::size_t a = 0; a < 3; ++a)
      while ((biased(high_[a]) >> shift) - (biased(low_[a]) >> shift) > 1) ++shift;
    std::array<Key, 8> starts;
    const std::size_t count = starting_cells(shift, starts);
    std::size_t from = 0;
    for (std::size_t i = 0; i < count; ++i) {
      from = next_index(from, starts[i]);
      const std::size_t to = next_index(from, after_cell(starts[i], shift));
      if (from < to) descend_cells(decode_key(starts[i]), starts[i], shift, from, to);
      from = to;
    }
  }

 private:
  static constexpr std::size_t kFewPoints = 64;  // not worth a search among
  static constexpr std::size_t kFewCells = 128;  // looked at one by one

  /// The first of so many cells from `first` on whose key is not less, without a branch.
  static std::size_t index_of(const Entry* first, std::size_t count, const Key& key) {
    const Entry* at = first;
    for (; count > 1; count -= count / 2) at += at[count / 2 - 1].first < key ? count / 2 : 0;
    return static_cast<std::size_t>(at - first) + (count > 0 && at->first < key);
  }

  /// The same from a cell on that is probably near.
  std::size_t next_index(std::size_t from, const Key& key) const {
    const Entry* const cells = grid_.cells_.data();
    const std::size_t count = grid_.cells_.size();
    std::size_t step = kFewCells / 2;
    while (from < count && step < count - from && cells[from + step - 1].first < key) {
      from += step;
      step *= 4;
    }
    return from + index_of(cells + from, std::min(step, count - from), key);
  }

  /// The first keys of the cells of side 2^shift that the box touches, in order.
  std::size_t starting_cells(int shift, std::array<Key, 8>& starts) const {
    std::size_t count = 0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      Index3 corner;
      bool twice = false;  // the same cell as of an earlier octant
      for (std::size_t a = 0; a < 3; ++a) {
        const bool upper = octant >> a & 1;
        const std::uint64_t cell = biased(upper ? high_[a] : low_[a]) >> shift;
        twice |= upper && cell == biased(low_[a]) >> shift;
        corner[a] = static_cast<std::int64_t>(cell << shift) + kLatticeMin;
      }
      if (twice) continue;
      const Key key = encode_key(corner);
      std::size_t at = count++;
      for (; at > 0 && key < starts[at - 1]; --at) starts[at] = starts[at - 1];
      starts[at] = key;
    }
    return count;
  }

  bool touches(const Index3& corner, int shift) const {
    const std::int64_t side = std::int64_t{1} << shift;
    bool apart = false;
    for (std::size_t a = 0; a < 3; ++a)
      apart |= corner[a] > high_[a] || corner[a] + side <= low_[a];
    return !apart;
  }

  static Index3 child(const Index3& corner, int shift, unsigned octant) {
    const std::int64_t half = std::int64_t{1} << (shift - 1);
    return {corner[0] + (octant & 1 ? half : 0), corner[1] + (octant & 2 ? half : 0),
            corner[2] + (octant & 4 ? half : 0)};
  }

  /// Which octant of a cell of side 2^shift a point of it lies in; quicker than its key.
  static unsigned octant_of(const Index3& point, int shift) {
    const auto upper = [&](std::size_t a) {
      return static_cast<unsigned>(biased(point[a]) >> (shift - 1)) & 1;
    };
    return upper(0) | upper(1) << 1 | upper(2) << 2;
  }

  /// Calls go on for the octants that the box touches, with the items of [from, to) in each, where
  /// find(octant, key, from, to) is the first item not before an octant, which begins at that key.
  template <class Find, class GoOn>
  void for_each_octant(const Index3& corner, const Key& first, int shift, std::size_t from,
                       std::size_t to, Find find, GoOn go_on) {
    Key key = first;
    bool aligned = true;  // `from` is where the octant begins
    for (unsigned octant = 0; octant < 8 && from < to; ++octant) {
      const Key next = after_cell(key, shift - 1);
      const Index3 at = child(corner, shift, octant);
      if (touches(at, shift - 1)) {
        if (!aligned) from = find(octant, key, from, to);
        const std::size_t end = find(octant + 1, next, from, to);
        if (from < end) go_on(at, key, from, end);
        from = end;
        aligned = true;
      } else {
        aligned = false;
      }
      key = next;
    }
  }

  void descend_cells(const Index3& corner, const Key& first, int shift, std::size_t from,
                     std::size_t to) {
    const bool near = shift - grid_.shift_ <= CellPlace::kBits - 2;
    if (near && to - from <= kFewCells) return look_at_cells(from, to);
    const auto find = [&](unsigned, const Key& key, std::size_t low, std::size_t high) {
      return low + index_of(grid_.cells_.data() + low, high - low, key);
    };
    for_each_octant(corner, first, shift, from, to, find,
                    [&](const Index3& at, const Key& key, std::size_t low, std::size_t high) {
                      descend_cells(at, key, shift - 1, low, high);
                    });
  }

  /// Cells that are less than half of the places away tell by their places whether they are
  /// touched.
  void look_at_cells(std::size_t from, std::size_t to) {
    std::array<std::uint32_t, kFewCells> touched;
    std::size_t count = 0;
    for (std::size_t i = from; i < to; ++i) {
      const std::uint32_t place = grid_.cells_[i].place;
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a)
        inside &=
            ((CellPlace::along(place, a) - first_cell_[a]) & CellPlace::kMask) <= more_cells_[a];
      touched[count] = static_cast<std::uint32_t>(i);
      count += inside;
    }
    for (std::size_t n = 0; n < count; ++n) {
      const Entry& cell = grid_.cells_[touched[n]];
      const std::size_t end = grid_.end_of(touched[n]);
      if (end - cell.begin <= kFewPoints)
        add(cell.begin, end);
      else
        descend_points(decode_key(cell.first), cell.first, grid_.shift_, cell.begin, end);
    }
  }

  void descend_points(const Index3& corner, const Key& first, int shift, std::size_t from,
                      std::size_t to) {
    const bool fine = longest_step_ * static_cast<double>(std::int64_t{1} << shift) <= radius_ / 2;
    if (shift == 0 || fine || to - from <= kFewPoints) return add(from, to);
    const auto find = [&](unsigned octant, const Key&, std::size_t low, std::size_t high) {
      const auto rest = grid_.points_.subspan(low, high - low);
      const auto before = [&](const Index3& point) { return octant_of(point, shift) < octant; };
      return low +
             static_cast<std::size_t>(std::ranges::partition_point(rest, before) - rest.begin());
    };
    for_each_octant(corner, first, shift, from, to, find,
                    [&](const Index3& at, const Key& key, std::size_t low, std::size_t high) {
                      descend_points(at, key, shift - 1, low, high);
                    });
  }

  void add(std::size_t from, std::size_t to) {
    if (!out_.empty() && out_.back().end == from)
      out_.back().end = to;
    else
      out_.push_back({from, to});
  }

  const CellGrid& grid_;
  Index3 low_, high_;  // the box with `radius` around it
  // The place of the first of the grid's cells that it touches, and how many more along each axis.
  std::array<std::uint32_t, 3> first_cell_, more_cells_;
  double radius_, longest_step_;
  std::vector<PointRange>& out_;
};

void CellGrid::gather_ranges(const IndexBox& box, double radius,
                             std::vector<PointRange>& out) const {
  out.clear();
  if (!points_.empty()) BoxSearch(*this, box, radius, out).run();
}

}  // namespace pss
