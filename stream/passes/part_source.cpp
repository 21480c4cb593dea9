#include "stream/passes/part_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "stream/passes/part_needs.h"
#include "stream/store/block.h"

namespace pss {

PartQueue::PartQueue(const PassSources& sources, std::size_t first_tile)
    : tiles_(sources.queries.tiles()),
      only_(sources.tiles ? &*sources.tiles : nullptr),
      next_(first_tile) {
  if (only_)
    next_ = static_cast<std::size_t>(std::ranges::lower_bound(*only_, first_tile) - only_->begin());
}

std::optional<std::size_t> PartQueue::next_tile() const {
  if (!only_) return next_ < tiles_.size() ? std::optional(next_) : std::nullopt;
  return next_ < only_->size() ? std::optional((*only_)[next_]) : std::nullopt;
}

std::optional<PartRange> PartQueue::pop() {
  if (!cut_.empty()) {
    const PartRange range = cut_.back();
    cut_.pop_back();
    return range;
  }
  const std::optional<std::size_t> tile = next_tile();
  if (!tile) return std::nullopt;
  ++next_;
  return PartRange{*tile, 0, tiles_[*tile].blocks};
}

void PartQueue::push_halves(const PartRange& range) {
  const std::size_t half = range.block_count / 2;
  cut_.push_back({range.tile, range.first_block + half, range.block_count - half});
  cut_.push_back({range.tile, range.first_block, half});
}

namespace {

/// A refusal names no radius that is a smaller part of the one it refuses.
constexpr int kSmallestRadius = 1024;

/// At least what any block of a planned tile takes as a part of its own, each of whose balls may
/// hold all that lies around one, and what all copies of one place take together.
PartPlan densest_part(const PartPlan& plan) {
  PartPlan part;
  part.lattice = plan.lattice;
  part.ordered = plan.ordered;
  part.own_points = std::min(plan.own_points, plan.ball_points);
  part.own.resize(part.own_points / kBlockPoints + 1);
  part.around.resize(part.own.size());
  part.near_points = part.ball_points = plan.ball_points;
  part.measured_ball = std::max(plan.measured_ball, plan.ball_points);
  return part;
}

/// At least what the parts of any tile take, cut as far as need be, where all look around only
/// `scale` times as far.
Result<std::uint64_t> needed_by_all(const PartLoader& loader, const Operator& op, double scale) {
  const std::span<const TileInfo> tiles = loader.queries().tiles();
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    PSS_ASSIGN(PartPlan plan, loader.plan({t, 0, tiles[t].blocks}));
    plan.around = op.neighbourhood().around(plan);
    for (Surround& surround : plan.around) surround.reach *= scale;
    PSS_TRY(loader.plan_near(plan, 0));
    most = std::max(most, part_bytes(op, densest_part(plan)));
    if (plan.ball_points == loader.neighbours().points()) break;  // it cannot be denser
  }
  return most;
}

/// A smaller radius that surely fits; of one place none holds fewer points.
Result<std::string> or_radius(const PartLoader& loader, const Operator& op, const Room& room) {
  for (int part = 2; part <= kSmallestRadius; part *= 2) {
    PSS_ASSIGN(const std::uint64_t needed, needed_by_all(loader, op, 1.0 / part));
    if (needed <= room.bytes) return fmt::format(", or a radius 1/{} of this one", part);
  }
  return std::string();
}

Result<bool> too_dense(const PartLoader& loader, const Operator& op, const PartPlan& plan,
                       const Room& room) {
  Index3 centre;
  for (std::size_t a = 0; a < 3; ++a) centre[a] = plan.box.min[a] / 2 + plan.box.max[a] / 2;
  const World3 place = to_world(plan.lattice, centre);
  double reach = 0;
  for (const Surround& surround : plan.around) reach = std::max(reach, surround.reach);
  const std::uint64_t bytes = part_bytes(op, plan);
  PSS_ASSIGN(std::uint64_t needed, needed_by_all(loader, op, 1));
  needed = std::max(needed, part_bytes(op, densest_part(plan)));
  PSS_ASSIGN(const std::string radius, or_radius(loader, op, room));
  const auto limit_for = [&](std::uint64_t part) {
    return sufficient_mib(room.limit, room.bytes, part);
  };
  return Error{Fault::kMemoryLimit,
               fmt::format("{}: near ({:.9g}, {:.9g}, {:.9g}) up to {} points lie within {:.6g} of "
                           "{} points, which takes {} MiB of the {} MiB that the memory limit "
                           "leaves; use --memory-limit {}M, which should do ({}M may){}",
                           loader.queries().path(), place[0], place[1], place[2], plan.near_points,
                           reach, plan.own_points, bytes >> 20, room.bytes >> 20, limit_for(needed),
                           limit_for(bytes), radius)};
}

/// Whether smaller parts of a tile might leave room for a second: not where what lies around each
/// takes the most of it.
bool cutting_helps(const Operator& op, const PartPlan& plan, std::uint64_t most_bytes) {
  PartPlan block = densest_part(plan);
  block.own_points = std::min<std::uint64_t>(plan.own_points, kBlockPoints);
  block.measured_ball = plan.measured_ball;
  return part_bytes(op, block) <= most_bytes;
}

/// A tile without points: nothing is read for it, and nothing lies around it.
std::optional<Part> empty_part(const PartRange& range) {
  Part part;
  part.range = range;
  return part;
}

}  // namespace

/// Two should fit at once, one to compute and one to load.
Result<bool> fits(const PartLoader& loader, const Operator& op, const PartPlan& plan,
                  const Room& room) {
  const std::uint64_t bytes = part_bytes(op, plan);
  if (bytes <= room.bytes / 2) return true;
  if (plan.range.block_count > 1 && (bytes > room.bytes || cutting_helps(op, plan, room.bytes / 2)))
    return false;
  if (bytes > room.bytes) return too_dense(loader, op, plan, room);
  return true;
}

std::uint64_t most_candidates(const Room& room) { return room.bytes / sizeof(Index3); }

PartSource::PartSource(const PassSources& sources, const Operator& op, const MemoryBudget& budget,
                       std::size_t first_tile, TakeMemory take_memory)
    : op_(op),
      room_(budget),
      loader_(sources, op.needs()),
      queue_(sources, first_tile),
      take_memory_(std::move(take_memory)) {}

Result<std::optional<Part>> PartSource::next() {
  while (const std::optional<PartRange> range = queue_.pop()) {
    PSS_ASSIGN(std::optional<Part> part, load(*range));
    if (part) return part;
  }
  return std::optional<Part>();
}

Result<std::optional<Part>> PartSource::load(const PartRange& range) {
  if (range.block_count == 0) return empty_part(range);
  PSS_ASSIGN(PartPlan plan, loader_.plan(range));
  Reservation memory;
  PSS_ASSIGN(const bool taken, take_memory(plan, memory));
  if (!taken) return std::optional<Part>();
  PSS_ASSIGN(Part part, loader_.load_own(plan));
  part.memory = std::move(memory);
  plan.around = op_.neighbourhood().around(plan, part);
  return load_around(plan, std::move(part));
}

Result<std::optional<Part>> PartSource::load_around(PartPlan& plan, Part part) {
  for (;;) {
    PSS_TRY(loader_.plan_near(plan, most_candidates(room_)));
    PSS_ASSIGN(bool taken, take_memory(plan, part.memory));
    if (!taken) return std::optional<Part>();
    PSS_TRY(loader_.load_near(plan, part));
    plan.near_points = part.candidates.size();
    const Preparation needed = prepare(op_, plan.lattice, part);
    if (needed.ball_points > 0) {
      plan.measured_ball = part.ball_points = needed.ball_points;
      PSS_ASSIGN(taken, take_memory(plan, part.memory));
      if (!taken) return std::optional<Part>();
    }
    if (!needed.wider) break;
    ++reloaded_;
    plan.around = part.around;
    part.drop_candidates();
  }
  part.memory.shrink_to(part_bytes(op_, plan));
  return std::optional(std::move(part));
}

Result<bool> PartSource::take_memory(const PartPlan& plan, Reservation& memory) {
  PSS_ASSIGN(const bool fit, fits(loader_, op_, plan, room_));
  if (fit && take_memory_(memory, part_bytes(op_, plan))) return true;
  if (plan.range.block_count > 1) {
    queue_.push_halves(plan.range);
    return false;
  }
  // What else is held is not known here; all that there was before, and this, is enough.
  return Error{Fault::kMemoryLimit,
               fmt::format("{}: a part of {} points does not fit beside what else is held; use "
                           "--memory-limit {}M or more",
                           loader_.queries().path(), plan.own_points,
                           sufficient_mib(room_.limit, 0, part_bytes(op_, plan)))};
}

}  // namespace pss
