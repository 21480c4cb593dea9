#include "stream/part_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pss {

std::optional<PartRange> PartQueue::pop() {
  if (!cut_.empty()) {
    const PartRange range = cut_.back();
    cut_.pop_back();
    return range;
  }
  if (next_tile_ == tiles_.size()) return std::nullopt;
  const std::size_t tile = next_tile_++;
  return PartRange{tile, 0, tiles_[tile].blocks};
}

void PartQueue::push_halves(const PartRange& range) {
  const std::size_t half = range.block_count / 2;
  cut_.push_back({range.tile, range.first_block + half, range.block_count - half});
  cut_.push_back({range.tile, range.first_block, half});
}

namespace {

/// Two should fit at once, one to compute and one to load.
std::uint64_t largest_part(const MemoryBudget& budget) { return budget.total() / 2; }

Error too_dense(const Store& source, const PartPlan& plan, std::uint64_t bytes,
                const MemoryBudget& budget) {
  Index3 centre;
  for (std::size_t a = 0; a < 3; ++a) centre[a] = plan.box.min[a] / 2 + plan.box.max[a] / 2;
  const World3 place = to_world(source.header().lattice, centre);
  double reach = 0;
  for (const Surround& surround : plan.around) reach = std::max(reach, surround.reach);
  const std::uint64_t needed = budget.limit() + bytes - std::min(bytes, budget.total());
  const double scale = std::sqrt(static_cast<double>(budget.total()) / static_cast<double>(bytes));
  return {
      Fault::kMemoryLimit,
      fmt::format("{}: near ({:.9g}, {:.9g}, {:.9g}) up to {} points lie within {:.6g} of {} "
                  "points, which takes {} MiB of the {} MiB that the memory limit leaves; use "
                  "--memory-limit {}M or more, or a radius of about {:.3g} times this one",
                  source.path(), place[0], place[1], place[2], plan.near_points, reach,
                  plan.own_points, bytes >> 20, budget.total() >> 20, (needed >> 20) + 1, scale)};
}

}  // namespace

Result<bool> fits(const Store& source, const Operator& op, const PartPlan& plan,
                  const MemoryBudget& budget) {
  const std::uint64_t bytes = op.bytes(plan);
  if (bytes > largest_part(budget) && plan.range.block_count > 1) return false;
  if (bytes > budget.total()) return too_dense(source, plan, bytes, budget);
  return true;
}

std::uint64_t most_candidates(const MemoryBudget& budget) {
  return budget.total() / sizeof(Index3);
}

PartSource::PartSource(const Store& source, const Operator& op, const MemoryBudget& budget,
                       std::size_t first_tile, TakeMemory take_memory)
    : op_(op),
      budget_(budget),
      loader_(source, op.needs()),
      queue_(first_tile, source.tiles()),
      take_memory_(std::move(take_memory)) {}

Result<std::optional<Part>> PartSource::next() {
  while (const std::optional<PartRange> range = queue_.pop()) {
    PSS_ASSIGN(std::optional<Part> part, load(*range));
    if (part) return part;
  }
  return std::optional<Part>();
}

Result<std::optional<Part>> PartSource::load(const PartRange& range) {
  PSS_ASSIGN(PartPlan plan, loader_.plan(range));
  Reservation memory;
  PSS_ASSIGN(const bool taken, take_memory(plan, memory));
  if (!taken) return std::optional<Part>();
  PSS_ASSIGN(Part part, loader_.load_own(plan));
  part.memory = std::move(memory);
  plan.around = op_.around(plan, part);
  return load_around(plan, std::move(part));
}

Result<std::optional<Part>> PartSource::load_around(PartPlan& plan, Part part) {
  for (;;) {
    PSS_TRY(loader_.plan_near(plan, most_candidates(budget_)));
    PSS_ASSIGN(bool taken, take_memory(plan, part.memory));
    if (!taken) return std::optional<Part>();
    PSS_TRY(loader_.load_near(plan, part));
    plan.near_points = part.candidates.size();
    const Preparation needed = op_.prepare(part);
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
  part.memory.shrink_to(op_.bytes(plan));
  return std::optional(std::move(part));
}

Result<bool> PartSource::take_memory(const PartPlan& plan, Reservation& memory) {
  PSS_ASSIGN(const bool fit, fits(loader_.source(), op_, plan, budget_));
  if (fit && take_memory_(memory, op_.bytes(plan))) return true;
  if (plan.range.block_count > 1) {
    queue_.push_halves(plan.range);
    return false;
  }
  return Error{Fault::kMemoryLimit,
               fmt::format("{}: a part of {} points does not fit beside what else is held; use a "
                           "larger --memory-limit",
                           loader_.source().path(), plan.own_points)};
}

}  // namespace pss
