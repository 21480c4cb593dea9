#include "stream/part.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "core/morton.h"

namespace pss {
namespace {

std::vector<IndexBox> tile_boxes(const Store& store) {
  std::vector<IndexBox> boxes;
  boxes.reserve(store.tiles().size());
  for (const TileInfo& tile : store.tiles()) boxes.push_back(tile.box);
  return boxes;
}

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

/// How many points lie within reach of any one own point, at most: by blocks.
std::uint64_t largest_ball(const Lattice& lattice, const PartPlan& plan) {
  const double reach_sq = plan.range.reach * plan.range.reach;
  std::uint64_t largest = 0;
  for (const BlockInfo& own : plan.own) {
    std::uint64_t points = 0;
    for (const BlockRef& near : plan.near)
      if (distance_sq(lattice, near.block.box, own.box) <= reach_sq) points += near.block.count;
    largest = std::max(largest, points);
  }
  return largest;
}

}  // namespace

PartLoader::PartLoader(const Store& source, const PartNeeds& needs)
    : source_(source),
      needs_(needs),
      exclusion_(source.header().schema),
      tiles_(tile_boxes(source)) {}

Result<PartPlan> PartLoader::plan(const PartRange& range) const {
  PartPlan plan;
  plan.range = range;
  PSS_ASSIGN(const std::vector<BlockInfo> index, source_.read_index(range.tile));
  for (std::size_t b = 0; b < range.block_count; ++b) {
    plan.own.push_back(index[range.first_block + b]);
    plan.own_points += plan.own.back().count;
    plan.box.add(plan.own.back().box);
  }
  const Lattice& lattice = source_.header().lattice;
  const double reach_sq = range.reach * range.reach;
  for (const std::size_t tile : tiles_.within(lattice, plan.box, range.reach)) {
    PSS_ASSIGN(std::vector<BlockInfo> blocks, source_.read_index(tile));
    for (BlockInfo& block : blocks) {
      if (distance_sq(lattice, block.box, plan.box) > reach_sq) continue;
      plan.near_points += block.count;
      plan.near.push_back({tile, std::move(block)});
    }
  }
  plan.ball_points = largest_ball(lattice, plan);
  return plan;
}

Result<Part> PartLoader::load(const PartPlan& plan) const {
  Part part;
  part.range = plan.range;
  part.box = plan.box;
  part.ball_points = plan.ball_points;
  PSS_TRY(load_own(plan, part));
  PSS_TRY(load_candidates(plan, part));
  return part;
}

Result<void> PartLoader::load_own(const PartPlan& plan, Part& part) const {
  const TileInfo& tile = source_.tiles()[plan.range.tile];
  const std::size_t source_size = source_.header().schema.row_size();
  part.first_row = plan.own.empty() ? tile.first_row : plan.own.front().first_row;
  part.own.resize(plan.own_points);
  part.rows.resize(plan.own_points * needs_.row_size);
  std::vector<std::byte> rows;
  std::size_t done = 0;
  for (const BlockInfo& block : plan.own) {
    PSS_TRY(source_.read_positions(tile, block, std::span(part.own).subspan(done, block.count)));
    rows.resize(block.count * source_size);
    PSS_TRY(source_.read_rows(tile, block, rows));
    for (std::size_t i = 0; i < block.count && needs_.kept_size > 0; ++i)
      std::memcpy(&part.rows[(done + i) * needs_.row_size], &rows[i * source_size],
                  needs_.kept_size);
    part.block_counts.push_back(block.count);
    done += block.count;
  }
  return {};
}

Result<void> PartLoader::read_near(const BlockRef& near, NearBlock& block) const {
  const TileInfo& tile = source_.tiles()[near.tile];
  block.positions.resize(near.block.count);
  block.excluded.assign(near.block.count, 0);
  PSS_TRY(source_.read_positions(tile, near.block, block.positions));
  if (exclusion_.active()) PSS_TRY(exclusion_.mark(source_, tile, near.block, block.excluded));
  if (!needs_.normals) return {};
  block.normals.resize(near.block.count);
  return needs_.normals->read(source_, tile, near.block, block.normals);
}

Result<void> PartLoader::load_candidates(const PartPlan& plan, Part& part) const {
  const Lattice& lattice = source_.header().lattice;
  const double reach_sq = plan.range.reach * plan.range.reach;
  part.candidates.reserve(plan.near_points);
  if (needs_.normals) part.normals.reserve(plan.near_points);
  NearBlock block;
  for (const BlockRef& near : plan.near) {
    PSS_TRY(read_near(near, block));
    const std::uint64_t row = near.block.first_row;
    const bool is_own = row >= part.first_row && row < part.first_row + plan.own_points;
    for (std::size_t i = 0; i < block.positions.size(); ++i) {
      if (block.excluded[i] || distance_sq(lattice, block.positions[i], plan.box) > reach_sq)
        continue;
      part.candidates.push_back(block.positions[i]);
      if (needs_.normals) part.normals.push_back(block.normals[i]);
      part.halo += is_own ? 0 : 1;
    }
  }
  sort_by_key(part.candidates, part.normals);
  return {};
}

}  // namespace pss
