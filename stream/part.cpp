#include "stream/part.h"

#include <algorithm>
#include <cstring>

#include "core/morton.h"

namespace pss {
namespace {

std::vector<IndexBox> tile_boxes(const Store& store) {
  std::vector<IndexBox> boxes;
  boxes.reserve(store.tiles().size());
  for (const TileInfo& tile : store.tiles()) boxes.push_back(tile.box);
  return boxes;
}

/// Sorts by key where the source does not have that order. Equal positions are interchangeable.
void sort_by_key(std::vector<Index3>& points) {
  const auto before = [](const Index3& a, const Index3& b) {
    return encode_key(a) < encode_key(b);
  };
  if (!std::is_sorted(points.begin(), points.end(), before))
    std::sort(points.begin(), points.end(), before);
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

PartLoader::PartLoader(const Store& source, std::size_t row_size)
    : source_(source),
      row_size_(row_size),
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
  PSS_TRY(load_own(plan, part));
  PSS_TRY(load_candidates(plan, part));
  return part;
}

Result<void> PartLoader::load_own(const PartPlan& plan, Part& part) const {
  const TileInfo& tile = source_.tiles()[plan.range.tile];
  const std::size_t source_size = source_.header().schema.row_size();
  part.first_row = plan.own.empty() ? tile.first_row : plan.own.front().first_row;
  part.own.resize(plan.own_points);
  part.rows.resize(plan.own_points * row_size_);
  std::vector<std::byte> rows;
  std::size_t done = 0;
  for (const BlockInfo& block : plan.own) {
    PSS_TRY(source_.read_positions(tile, block, std::span(part.own).subspan(done, block.count)));
    rows.resize(block.count * source_size);
    PSS_TRY(source_.read_rows(tile, block, rows));
    for (std::size_t i = 0; i < block.count && source_size > 0; ++i)
      std::memcpy(&part.rows[(done + i) * row_size_], &rows[i * source_size], source_size);
    part.block_counts.push_back(block.count);
    done += block.count;
  }
  return {};
}

Result<void> PartLoader::load_candidates(const PartPlan& plan, Part& part) const {
  const Lattice& lattice = source_.header().lattice;
  const double reach_sq = plan.range.reach * plan.range.reach;
  part.candidates.reserve(plan.near_points);
  std::vector<Index3> positions;
  std::vector<std::uint8_t> excluded;
  for (const auto& [tile_number, block] : plan.near) {
    const TileInfo& tile = source_.tiles()[tile_number];
    positions.resize(block.count);
    excluded.assign(block.count, 0);
    PSS_TRY(source_.read_positions(tile, block, positions));
    if (exclusion_.active()) PSS_TRY(exclusion_.mark(source_, tile, block, excluded));
    const bool is_own =
        block.first_row >= part.first_row && block.first_row < part.first_row + plan.own_points;
    for (std::size_t i = 0; i < block.count; ++i) {
      if (excluded[i] || distance_sq(lattice, positions[i], plan.box) > reach_sq) continue;
      part.candidates.push_back(positions[i]);
      part.halo += is_own ? 0 : 1;
    }
  }
  sort_by_key(part.candidates);
  return {};
}

}  // namespace pss
