#include "stream/passes/part.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <numeric>

#include "core/morton.h"
#include "stream/passes/each_block.h"

namespace pss {
namespace {

bool before(const Index3& a, const Index3& b) { return encode_key(a) < encode_key(b); }

template <class T>
std::vector<T> permuted(const std::vector<T>& values, std::span<const std::uint32_t> order) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::uint32_t i : order) sorted.push_back(values[i]);
  return sorted;
}

/// Sorts by key where the source does not have that order.
///
/// Equal positions are interchangeable; with normals they keep the order of their rows.
void sort_by_key(std::vector<Index3>& points, std::vector<Normal>& normals) {
  if (std::is_sorted(points.begin(), points.end(), before)) return;
  if (normals.empty()) return std::sort(points.begin(), points.end(), before);
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return points[a] == points[b] ? a < b : before(points[a], points[b]);
  });
  points = permuted(points, order);
  normals = permuted(normals, order);
}

/// A squared distance that decides what is loaded: more does no harm, so rounding may err that way.
constexpr double kRoomForRounding = 1 + 1e-12;

/// As distance_sq of boxes, which calls std::fma: too slow for every point of a halo.
double gap_sq(const Lattice& lattice, const IndexBox& a, const IndexBox& b) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t gap =
        std::max({a.min[axis] - b.max[axis], b.min[axis] - a.max[axis], std::int64_t{0}});
    const double length = lattice.scale[axis] * static_cast<double>(gap);
    sum += length * length;
  }
  return sum;
}

bool reaches(const Lattice& lattice, const Surround& surround, const IndexBox& box) {
  return gap_sq(lattice, surround.box, box) <= surround.reach * surround.reach * kRoomForRounding;
}

bool contains(const IndexBox& outer, const IndexBox& inner) {
  for (std::size_t a = 0; a < 3; ++a)
    if (inner.min[a] < outer.min[a] || inner.max[a] > outer.max[a]) return false;
  return true;
}

/// Decides which points of one block some surround reaches.
class Wanted {
 public:
  Wanted(const PartPlan& plan, const BlockRef& near) : plan_(plan), near_(near) {
    for (const std::uint32_t s : near.around) all_ |= contains(plan.around[s].box, near.block.box);
  }

  bool operator()(const Index3& p) {
    if (all_) return true;
    const IndexBox box{p, p};
    // Consecutive points are mostly wanted by the same one.
    if (last_ && reaches(plan_.lattice, *last_, box)) return true;
    for (const std::uint32_t s : near_.around) {
      if (!reaches(plan_.lattice, plan_.around[s], box)) continue;
      last_ = &plan_.around[s];
      return true;
    }
    return false;
  }

 private:
  const PartPlan& plan_;
  const BlockRef& near_;
  const Surround* last_ = nullptr;
  bool all_ = false;
};

template <class T>
void close_gaps(std::vector<T>& values, std::span<const PointRange> ranges) {
  if (values.empty()) return;
  std::size_t to = 0;
  for (const PointRange& range : ranges) {
    // Onto itself where there was no gap.
    for (std::size_t i = range.begin; i < range.end; ++i) values[to++] = values[i];
  }
  values.resize(to);
}

/// Moves the ranges together; they keep their lengths.
void close_gaps(Part& part, std::span<const PointRange> ranges) {
  close_gaps(part.candidates, ranges);
  close_gaps(part.normals, ranges);
}

}  // namespace

PartLoader::PartLoader(const PassSources& sources, const PartNeeds& needs)
    : sources_(sources), needs_(needs), tiles_(BoxTree::of(sources.neighbours.tiles())) {
  assert(sources.queries.lattice() == sources.neighbours.lattice());
}

void Part::drop_candidates() {
  grid.reset();
  candidates = {};
  normals = {};
  halo = 0;
}

Result<PartPlan> PartLoader::plan(const PartRange& range) const {
  PartPlan plan;
  plan.range = range;
  plan.lattice = neighbours().lattice();
  plan.ordered = neighbours().header().ordered;
  PSS_ASSIGN(const std::vector<BlockInfo> index, queries().read_index(range.tile));
  for (std::size_t b = 0; b < range.block_count; ++b) {
    plan.own.push_back(index[range.first_block + b]);
    plan.own_points += plan.own.back().count;
    plan.box.add(plan.own.back().box);
  }
  return plan;
}

/// The tiles that any surround reaches, ascending, and which surrounds reach into each.
std::vector<std::vector<std::uint32_t>> PartLoader::surrounds_by_tile(
    const std::vector<Surround>& around, std::vector<std::size_t>& tiles) const {
  std::vector<std::pair<std::size_t, std::uint32_t>> pairs;
  for (std::uint32_t s = 0; s < around.size(); ++s)
    for (const std::size_t tile :
         tiles_.within(neighbours().lattice(), around[s].box, around[s].reach * kRoomForRounding))
      pairs.emplace_back(tile, s);
  std::ranges::sort(pairs);
  std::vector<std::vector<std::uint32_t>> surrounds;
  for (const auto& [tile, surround] : pairs) {
    if (tiles.empty() || tiles.back() != tile) {
      tiles.push_back(tile);
      surrounds.emplace_back();
    }
    surrounds.back().push_back(surround);
  }
  return surrounds;
}

Result<void> PartLoader::plan_near(PartPlan& plan, std::uint64_t most_points) const {
  plan.near.clear();
  plan.near_points = plan.measured_ball = 0;
  std::vector<std::uint64_t> balls(plan.around.size(), 0);
  std::vector<std::size_t> tiles;
  const auto surrounds = surrounds_by_tile(plan.around, tiles);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    PSS_ASSIGN(std::vector<BlockInfo> blocks, neighbours().read_index(tiles[t]));
    for (BlockInfo& block : blocks) {
      BlockRef near{tiles[t], {}, {}};
      for (const std::uint32_t s : surrounds[t]) {
        if (!reaches(plan.lattice, plan.around[s], block.box)) continue;
        near.around.push_back(s);
        balls[s] += block.count;
      }
      if (near.around.empty()) continue;
      plan.near_points += block.count;
      near.block = std::move(block);
      if (plan.near_points <= most_points) plan.near.push_back(std::move(near));
    }
  }
  plan.ball_points = balls.empty() ? 0 : *std::ranges::max_element(balls);
  return {};
}

Result<Part> PartLoader::load_own(const PartPlan& plan) const {
  Part part;
  part.range = plan.range;
  const TileInfo& tile = queries().tiles()[plan.range.tile];
  part.first_row = plan.own.empty() ? tile.first_row : plan.own.front().first_row;
  part.own.resize(plan.own_points);
  part.rows.resize(plan.own_points * needs_.row_size);
  if (queries().excludes_some()) part.excluded.resize(plan.own_points);
  for (const BlockInfo& block : plan.own) part.block_counts.push_back(block.count);
  PSS_TRY(
      for_each_block(plan.own.size(), [&](std::size_t b) { return read_own(plan.own[b], part); }));
  return part;
}

Result<void> PartLoader::read_own(const BlockInfo& block, Part& part) const {
  const std::size_t tile = part.range.tile;
  const std::size_t source_size = queries().schema().row_size();
  const std::size_t first = block.first_row - part.first_row;
  PSS_TRY(queries().read_positions(tile, block, std::span(part.own).subspan(first, block.count)));
  if (!part.excluded.empty())
    PSS_TRY(
        queries().mark_excluded(tile, block, std::span(part.excluded).subspan(first, block.count)));
  if (needs_.kept.empty()) return {};
  std::vector<std::byte> rows(block.count * source_size);
  PSS_TRY(queries().read_rows(tile, block, rows));
  for (const KeptBytes& kept : needs_.kept)
    for (std::size_t i = 0; i < block.count; ++i)
      std::memcpy(&part.rows[(first + i) * needs_.row_size + kept.to],
                  &rows[i * source_size + kept.from], kept.size);
  return {};
}

/// Whether a near block is one of the part's own.
bool PartLoader::is_own(const BlockRef& near, const Part& part) const {
  return sources_.same() && near.block.first_row >= part.first_row &&
         near.block.first_row - part.first_row < part.own.size();
}

/// Takes a near block from the part's own points, where it has been read already.
void PartLoader::copy_own(const Part& part, const BlockInfo& block, NearBlock& near) {
  const std::size_t first = block.first_row - part.first_row;
  std::ranges::copy(std::span(part.own).subspan(first, block.count), near.positions.begin());
  if (part.excluded.empty()) return;
  std::ranges::copy(std::span(part.excluded).subspan(first, block.count), near.excluded.begin());
}

Result<void> PartLoader::read_near(const BlockRef& near, const Part& part, NearBlock& block) const {
  block.positions.resize(near.block.count);
  block.excluded.assign(near.block.count, 0);
  if (is_own(near, part))
    copy_own(part, near.block, block);
  else
    PSS_TRY(neighbours().read_positions(near.tile, near.block, block.positions));
  if (neighbours().excludes_some() && !is_own(near, part))
    PSS_TRY(neighbours().mark_excluded(near.tile, near.block, block.excluded));
  if (!needs_.normals) return {};
  block.normals.resize(near.block.count);
  return needs_.normals->read(neighbours(), near.tile, near.block, block.normals);
}

Result<void> PartLoader::load_near(const PartPlan& plan, Part& part) const {
  part.drop_candidates();
  part.around = plan.around;
  part.ball_points = plan.ball_points;
  part.candidates.resize(plan.near_points);
  if (needs_.normals) part.normals.resize(plan.near_points);
  // Every block writes where it would stand if all of its points were wanted.
  std::vector<PointRange> ranges;
  std::size_t end = 0;
  for (const BlockRef& near : plan.near) {
    ranges.push_back({end, end});
    end += near.block.count;
  }
  PSS_TRY(for_each_block(plan.near.size(),
                         [&](std::size_t b) { return load_block(plan, b, ranges[b], part); }));
  close_gaps(part, ranges);
  part.halo = part.candidates.size();
  for (std::size_t b = 0; b < ranges.size(); ++b)
    if (is_own(plan.near[b], part)) part.halo -= ranges[b].end - ranges[b].begin;
  if (!plan.ordered) sort_by_key(part.candidates, part.normals);
  return {};
}

Result<void> PartLoader::load_block(const PartPlan& plan, std::size_t number, PointRange& range,
                                    Part& part) const {
  const BlockRef& near = plan.near[number];
  NearBlock block;
  PSS_TRY(read_near(near, part, block));
  Wanted wanted(plan, near);
  for (std::size_t i = 0; i < block.positions.size(); ++i) {
    if (block.excluded[i] || !wanted(block.positions[i])) continue;
    part.candidates[range.end] = block.positions[i];
    if (needs_.normals) part.normals[range.end] = block.normals[i];
    ++range.end;
  }
  return {};
}

}  // namespace pss
