#include "core/neighbours.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/cell_borders.h"
#include "core/touched_cells.h"

namespace pss {
namespace {

/// How many times cells are halved below the size that suits a single ball.
constexpr int kFiner = 1;

/// Offsets on their way into vectors, which would clear what they are grown by.
class OffsetBuffer {
 public:
  explicit OffsetBuffer(Offsets& out) : out_(out) {}
  ~OffsetBuffer() { flush(); }
  OffsetBuffer(const OffsetBuffer&) = delete;
  OffsetBuffer& operator=(const OffsetBuffer&) = delete;

  /// Keeps the offset if `inside`, without a branch.
  void add(double x, double y, double z, bool inside) {
    x_[count_] = x;
    y_[count_] = y;
    z_[count_] = z;
    count_ += inside;
    if (count_ == kCapacity) flush();
  }

 private:
  static constexpr std::size_t kCapacity = 256;

  void flush() {
    out_.x.insert(out_.x.end(), x_.data(), x_.data() + count_);
    out_.y.insert(out_.y.end(), y_.data(), y_.data() + count_);
    out_.z.insert(out_.z.end(), z_.data(), z_.data() + count_);
    count_ = 0;
  }

  Offsets& out_;
  std::size_t count_ = 0;
  std::array<double, kCapacity> x_, y_, z_;
};

/// Decides |d|^2 < radius^2 by length_sq, which is called only where a plain sum cannot tell:
/// where the processor is not known to fuse, std::fma is a function call.
class InsideBall {
 public:
  explicit InsideBall(double radius)
      : radius_sq_(radius * radius),
        surely_(radius_sq_ * (1 - kSlack)),
        perhaps_(radius_sq_ * (1 + kSlack)) {}

  bool operator()(double dx, double dy, double dz) const {
    const double plain = dx * dx + dy * dy + dz * dz;
    if (plain >= surely_ && plain <= perhaps_) [[unlikely]]
      return length_sq(dx, dy, dz) < radius_sq_;
    return plain < surely_;
  }

 private:
  double radius_sq_, surely_, perhaps_;
};

/// Comparing them as arrays is a call.
bool same(const Index3& a, const Index3& b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

/// Within kSlack of distance_sq, without a call.
double plain_distance_sq(const Lattice& lattice, const Index3& a, const Index3& b) {
  World3 d;
  for (std::size_t x = 0; x < 3; ++x) d[x] = lattice.scale[x] * static_cast<double>(b[x] - a[x]);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/// The k smallest of the values that it is shown: one for each position, or one for each point.
template <bool kEach>
class Smallest {
 public:
  static constexpr bool kEachPoint = kEach;
  explicit Smallest(std::size_t k) : k_(k) { heap_.reserve(k); }

  bool full() const { return heap_.size() == k_; }
  double largest() const { return heap_.front(); }
  void clear() { heap_.clear(); }

  void add(double value, const Index3&) {
    if (full()) {
      if (value >= largest()) return;
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.pop_back();
    }
    heap_.push_back(value);
    std::push_heap(heap_.begin(), heap_.end());
  }

 private:
  std::size_t k_;
  std::vector<double> heap_;
};

}  // namespace

void Offsets::clear() {
  x.clear();
  y.clear();
  z.clear();
}

CellGrid::CellGrid(const Lattice& lattice, std::span<const Index3> points, double radius)
    : lattice_(lattice), points_(points) {
  assert(radius > 0);
  assert(points.size() < std::numeric_limits<std::uint32_t>::max());
  assert(std::ranges::is_sorted(points, {}, encode_key));
  if (points.empty()) return;
  // Finer cells than one ball would like best: many balls together use smaller ones.
  const int best = BallBox(lattice, {points[points.size() / 2]}, radius).shift();
  const std::vector<Borders> borders = count_borders(points);
  shift_ = affordable_shift(borders, points.size(), std::max(best - kFiner, 0));
  std::vector<std::size_t> firsts;  // cells before those that begin in each block
  std::size_t count = 1;
  for (const Borders& block : borders) {
    firsts.push_back(firsts.empty() ? 0 : count);
    count += borders_above(block, shift_);
  }
  cells_.resize(count);
  for_each_block(points.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::size_t cell = firsts[block];
    for (std::size_t i = begin; i < end; ++i)
      if (i == 0 || common_shift(points[i - 1], points[i]) > shift_)
        cells_[cell++] = {cell_of(encode_key(points[i]), kLatticeBits - shift_).first,
                          static_cast<std::uint32_t>(i), CellPlace::of(points[i], shift_)};
  });
}

std::size_t CellGrid::bytes_for(std::size_t points) {
  return (points / kPointsPerCell + 1) * sizeof(Entry) +
         block_count(points) * (sizeof(Borders) + 2 * sizeof(std::size_t));
}

std::size_t CellGrid::end_of(std::size_t entry) const {
  return entry + 1 < cells_.size() ? cells_[entry + 1].begin : points_.size();
}

/// The first point whose key is not less than `key`, which begins a cell of side 2^shift.
///
/// `entry` is where to start among the cells, and is moved on: keys must not descend.
std::size_t CellGrid::lower_bound(const Key& key, int shift, std::size_t& entry) const {
  const auto begin = cells_.begin() + static_cast<std::ptrdiff_t>(entry);
  const auto found = std::lower_bound(begin, cells_.end(), key,
                                      [](const Entry& e, const Key& k) { return e.first < k; });
  entry = static_cast<std::size_t>(found - cells_.begin());
  const bool between_cells = shift >= shift_ || (found != cells_.end() && found->first == key);
  if (between_cells || entry == 0) return entry < cells_.size() ? found->begin : points_.size();
  --entry;  // the key lies within this cell, or after its last point
  const auto within = points_.subspan(cells_[entry].begin, end_of(entry) - cells_[entry].begin);
  return cells_[entry].begin +
         static_cast<std::size_t>(std::ranges::lower_bound(within, key, {}, encode_key) -
                                  within.begin());
}

/// Calls visit(begin, end) on ascending ranges of points that hold all of the ball.
template <class Visit>
void CellGrid::visit_ball(const Query& query, double radius, Visit visit) const {
  if (points_.empty()) return;
  const TouchedCells touched(lattice_, query, radius, shift_);
  std::size_t entry = 0;
  for (std::size_t i = 0; i < touched.count; ++i) {
    const std::size_t begin = lower_bound(touched.first[i], touched.shift, entry);
    if (begin == points_.size()) return;
    const Key after = after_cell(touched.first[i], touched.shift);
    const std::size_t end = lower_bound(after, touched.shift, entry);
    if (begin < end) visit(begin, end);
  }
}

void CellGrid::gather(const Query& query, double radius, Offsets& out) const {
  out.clear();
  OffsetBuffer buffer(out);
  const InsideBall inside(radius);
  visit_ball(query, radius, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      World3 d;
      for (std::size_t a = 0; a < 3; ++a)
        d[a] = lattice_.scale[a] * static_cast<double>(points_[i][a] - query.position[a]) -
               query.remainder[a];
      buffer.add(d[0], d[1], d[2], inside(d[0], d[1], d[2]));
    }
  });
}

/// One past the last copy of point i, in time logarithmic in their number.
std::size_t CellGrid::end_of_copies(std::size_t i, std::size_t end) const {
  std::size_t copy = i;
  std::size_t step = 1;
  for (; copy + step < end && points_[copy + step] == points_[i]; step *= 2) copy += step;
  std::size_t other = std::min(copy + step, end);
  while (other - copy > 1) {
    const std::size_t middle = copy + (other - copy) / 2;
    (points_[middle] == points_[i] ? copy : other) = middle;
  }
  return other;
}

/// A radius that would hold k points if the position's cell were an evenly covered sheet.
double CellGrid::first_guess(const Index3& position, int k) const {
  const Key key = cell_of(encode_key(position), kLatticeBits - shift_).first;
  std::size_t entry = 0;
  const std::size_t begin = lower_bound(key, shift_, entry);
  const std::size_t end = lower_bound(after_cell(key, shift_), shift_, entry);
  const double held = static_cast<double>(std::max<std::size_t>(end - begin, 1));
  const double side = std::ldexp(std::ranges::max(lattice_.scale), shift_);
  return side * std::sqrt((k + 1) / (3 * held));
}

/// Shows `nearest` the squared distances and the places of the distinct positions within `radius`,
/// but the own; or of all points but one at the own.
///
/// Most lie farther than what is known, which a plain sum tells; the rest are decided by length_sq.
template <class Nearest>
void CellGrid::add_distances(const Index3& position, double radius, Nearest& nearest) const {
  double perhaps = radius * radius * (1 + 2 * kSlack);
  visit_ball({position}, radius * (1 + kSlack), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index3& point = points_[i];
      std::size_t points = 1;
      if (i + 1 < end && same(points_[i + 1], point)) {
        const std::size_t copies = end_of_copies(i, end);
        if constexpr (Nearest::kEachPoint) points = copies - i;
        i = copies - 1;
      }
      if (plain_distance_sq(lattice_, position, point) > perhaps) continue;
      if (same(point, position) && (!Nearest::kEachPoint || --points == 0)) continue;
      const double d = distance_sq(lattice_, position, point);
      if (std::sqrt(d) > radius) continue;
      nearest.add(d, point);
      for (; points > 1 && !(nearest.full() && d >= nearest.largest()); --points)
        nearest.add(d, point);
      if (nearest.full()) perhaps = std::min(perhaps, nearest.largest() * (1 + 2 * kSlack));
    }
  });
}

/// Fills `nearest` with the k nearest; it is not full where fewer lie within `cap`.
template <class Nearest>
void CellGrid::search(const Index3& position, int k, double cap, Nearest& nearest) const {
  if (points_.empty() || !(cap > 0)) return;
  const double everywhere = std::ldexp(std::ranges::max(lattice_.scale), kLatticeBits + 2);
  const double widest = std::min(cap, everywhere);
  for (double radius = first_guess(position, k);; radius *= 2) {
    radius = std::min(radius, widest);
    nearest.clear();
    add_distances(position, radius, nearest);
    // All that is nearer than the radius has been seen, so k of these are the k nearest.
    if (nearest.full() || radius >= widest) return;
  }
}

std::optional<double> CellGrid::kth_distance(const Index3& position, int k, double cap) const {
  assert(k >= 1);
  Smallest<false> nearest(static_cast<std::size_t>(k));
  search(position, k, cap, nearest);
  if (!nearest.full()) return std::nullopt;
  return std::sqrt(nearest.largest());
}

std::optional<double> CellGrid::kth_point_distance(const Index3& position, int k,
                                                   double cap) const {
  assert(k >= 1);
  Smallest<true> nearest(static_cast<std::size_t>(k));
  search(position, k, cap, nearest);
  if (!nearest.full()) return std::nullopt;
  return std::sqrt(nearest.largest());
}

BallSum CellGrid::sum_ball(const Index3& position, double radius) const {
  BallSum sum;
  const double perhaps = radius * radius * (1 + 2 * kSlack);
  visit_ball({position}, radius * (1 + kSlack), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index3& point = points_[i];
      const std::size_t first = i;
      if (i + 1 < end && same(points_[i + 1], point)) i = end_of_copies(i, end) - 1;
      if (plain_distance_sq(lattice_, position, point) > perhaps) continue;
      const double distance = std::sqrt(distance_sq(lattice_, position, point));
      if (!(distance < radius)) continue;
      const std::size_t points = i + 1 - first;
      sum.points += points;
      sum.distances += static_cast<double>(points) * distance;
      sum.heights += static_cast<double>(points) * static_cast<double>(point[2] - position[2]);
    }
  });
  return sum;
}

std::vector<Neighbour> CellGrid::nearest(const Index3& position, std::size_t count) const {
  assert(count >= 1);
  NearestPositions nearest(count);
  search(position, static_cast<int>(count), HUGE_VAL, nearest);
  return nearest.take();
}

}  // namespace pss
