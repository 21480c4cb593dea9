#include "stream/scheduler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "core/parallel.h"
#include "stream/committer.h"
#include "stream/stopwatch.h"

namespace pss {
namespace {

/// What remains to be done, in order: whole tiles, or parts of one that was cut.
class PartQueue {
 public:
  PartQueue(std::size_t first_tile, std::span<const TileInfo> tiles, double first_reach)
      : next_tile_(first_tile), tiles_(tiles), first_reach_(first_reach), reach_(first_reach) {}

  std::optional<PartRange> pop() {
    if (!cut_.empty()) {
      const PartRange range = cut_.back();
      cut_.pop_back();
      return range;
    }
    if (next_tile_ == tiles_.size()) return std::nullopt;
    const std::size_t tile = next_tile_++;
    reach_ = std::max(first_reach_, reach_ / 2);  // what the last tile needed may be too much now
    return PartRange{tile, 0, tiles_[tile].blocks, reach_, 0};
  }

  /// What was measured of the whole may be too much for a half.
  void push_halves(const PartRange& range) {
    const std::size_t half = range.block_count / 2;
    cut_.push_back(
        {range.tile, range.first_block + half, range.block_count - half, range.reach, 0});
    cut_.push_back({range.tile, range.first_block, half, range.reach, 0});
  }

  void push_again(const PartRange& range) {
    reach_ = range.reach;
    cut_.push_back(range);
  }

 private:
  std::size_t next_tile_;
  std::span<const TileInfo> tiles_;
  double first_reach_, reach_;
  std::vector<PartRange> cut_;  ///< the last is the next
};

/// The refusal of a block that does not fit with its halo.
Error too_dense(const Store& source, const PartPlan& plan, std::uint64_t bytes,
                const MemoryBudget& budget) {
  Index3 centre;
  for (std::size_t a = 0; a < 3; ++a) centre[a] = plan.box.min[a] / 2 + plan.box.max[a] / 2;
  const World3 place = to_world(source.header().lattice, centre);
  const std::uint64_t needed = budget.limit() + bytes - budget.total();
  const double scale = std::sqrt(static_cast<double>(budget.total()) / static_cast<double>(bytes));
  return {
      Fault::kMemoryLimit,
      fmt::format("{}: near ({:.9g}, {:.9g}, {:.9g}) up to {} points lie within {:.6g} of {} "
                  "points, which takes {} MiB of the {} MiB that the memory limit leaves; use "
                  "--memory-limit {}M or a radius of about {:.3g} times this one",
                  source.path(), place[0], place[1], place[2], plan.near_points, plan.range.reach,
                  plan.own_points, bytes >> 20, budget.total() >> 20, (needed >> 20) + 1, scale)};
}

/// The next part that fits, cutting tiles that do not. Empty at the end.
///
/// Two parts should fit at once, so that one is loaded while the other is computed.
Result<std::optional<PartPlan>> next_plan(const PartLoader& loader, const Operator& op,
                                          PartQueue& queue, const MemoryBudget& budget) {
  while (const std::optional<PartRange> range = queue.pop()) {
    PSS_ASSIGN(PartPlan plan, loader.plan(*range));
    const std::uint64_t bytes = op.bytes(plan);
    if (bytes > budget.total() / 2 && range->block_count > 1) {
      queue.push_halves(*range);
      continue;
    }
    if (bytes > budget.total()) return too_dense(loader.source(), plan, bytes, budget);
    return std::optional(std::move(plan));
  }
  return std::optional<PartPlan>();
}

/// A part on its way: planned, and loaded where its memory could be had.
struct Fetched {
  std::optional<PartPlan> plan;  ///< empty at the end
  std::optional<Part> part;
};

class Pipeline {
 public:
  Pipeline(const Store& source, const Operator& op, StoreWriter& result, MemoryBudget& budget,
           Monitor& monitor)
      : source_(source),
        op_(op),
        budget_(budget),
        monitor_(monitor),
        loader_(source, op.needs()),
        queue_(result.tiles().size(), source.tiles(), op.first_reach()),
        committer_(result, op) {}

  Result<ScheduleSummary> run() {
    for (;;) {
      PSS_ASSIGN(Fetched fetched, next());
      if (!fetched.plan) break;
      PSS_TRY(load_if_missing(fetched));
      Part& part = *fetched.part;
      if (const std::optional<PartRange> needed = op_.prepare(part)) {
        ++summary_.reloaded_parts;
        queue_.push_again(*needed);
        continue;
      }
      ahead_ = std::async(std::launch::async, [this] { return fetch(); });
      PSS_TRY(compute(part));
    }
    PSS_TRY(committer_.drain());
    return summary_;
  }

 private:
  Result<Fetched> fetch() {
    PSS_ASSIGN(Fetched fetched, plan_next());
    if (fetched.plan) PSS_TRY(try_load(fetched));
    return fetched;
  }

  Result<Fetched> plan_next() {
    PSS_ASSIGN(std::optional<PartPlan> plan, next_plan(loader_, op_, queue_, budget_));
    return Fetched{std::move(plan), std::nullopt};
  }

  Result<void> try_load(Fetched& fetched) {
    const PartPlan& plan = *fetched.plan;
    std::optional<Reservation> memory = budget_.reserve(op_.bytes(plan));
    if (!memory) return {};
    PSS_ASSIGN(fetched.part, loader_.load(plan));
    fetched.part->memory = std::move(*memory);
    return {};
  }

  /// The part that was read ahead, or one read now.
  Result<Fetched> next() {
    const Stopwatch watch;
    Result<Fetched> fetched = ahead_.valid() ? ahead_.get() : fetch();
    summary_.wait_seconds += watch.seconds();
    return fetched;
  }

  /// Loads a part whose memory was taken when it was planned: now all but the queue's is free.
  Result<void> load_if_missing(Fetched& fetched) {
    if (fetched.part) return {};
    const Stopwatch watch;
    PSS_TRY(committer_.drain());
    PSS_TRY(try_load(fetched));
    summary_.wait_seconds += watch.seconds();
    if (fetched.part) return {};
    return Error{Fault::kMemoryLimit,
                 fmt::format("{}: a part of {} points does not fit beside what else is held; use a "
                             "larger --memory-limit",
                             source_.path(), fetched.plan->own_points)};
  }

  Result<void> compute(Part& part) {
    const Stopwatch watch;
    FinishedPart finished;
    finished.notes = op_.apply(part, monitor_);
    if (monitor_.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    finished.blocks = encode(part);
    count(part, finished);
    part.own = {};
    part.rows = {};
    part.candidates = {};
    part.normals = {};
    part.supports = {};
    std::uint64_t bytes = 0;
    for (const EncodedBlock& block : finished.blocks) bytes += block.bytes.capacity();
    part.memory.shrink_to(bytes);
    finished.memory = std::move(part.memory);
    summary_.compute_seconds += watch.seconds();
    return committer_.push(std::move(finished));
  }

  std::vector<EncodedBlock> encode(const Part& part) const {
    const Schema& schema = op_.result_header().schema;
    std::vector<std::size_t> starts;
    std::size_t start = 0;
    for (const std::uint32_t points : part.block_counts) {
      starts.push_back(start);
      start += points;
    }
    std::vector<EncodedBlock> blocks(part.block_counts.size());
    parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        blocks[b] =
            encode_block(schema, std::span(part.own).subspan(starts[b], part.block_counts[b]),
                         std::span(part.rows).subspan(starts[b] * schema.row_size(),
                                                      part.block_counts[b] * schema.row_size()));
    });
    return blocks;
  }

  void count(const Part& part, FinishedPart& finished) {
    const TileInfo& tile = source_.tiles()[part.range.tile];
    finished.cell = tile.cell;
    finished.last_of_tile = part.range.first_block + part.range.block_count == tile.blocks;
    ++summary_.parts;
    summary_.tiles += finished.last_of_tile ? 1 : 0;
    summary_.own_points += part.own.size();
    summary_.halo_points += part.halo;
    monitor_.advance(0, finished.last_of_tile ? 1 : 0);
  }

  const Store& source_;
  const Operator& op_;
  MemoryBudget& budget_;
  Monitor& monitor_;
  PartLoader loader_;
  PartQueue queue_;
  ScheduleSummary summary_;
  Committer committer_;
  std::future<Result<Fetched>> ahead_;  ///< last: waited for before anything it uses goes
};

}  // namespace

Result<ScheduleSummary> run_operator(const Store& source, const Operator& op, StoreWriter& result,
                                     MemoryBudget& budget, Monitor& monitor) {
  const Stopwatch watch;
  const std::uint64_t resumed = result.tiles().size();
  PSS_ASSIGN(ScheduleSummary summary, Pipeline(source, op, result, budget, monitor).run());
  summary.resumed_tiles = resumed;
  summary.seconds = watch.seconds();
  return summary;
}

Result<ScheduleEstimate> estimate_operator(const Store& source, const Operator& op,
                                           MemoryBudget& budget) {
  const PartLoader loader(source, op.needs());
  PartQueue queue(0, source.tiles(), op.first_reach());
  ScheduleEstimate estimate;
  estimate.tiles = source.tiles().size();
  std::uint64_t largest = 0;
  for (;;) {
    PSS_ASSIGN(const std::optional<PartPlan> plan, next_plan(loader, op, queue, budget));
    if (!plan) break;
    ++estimate.parts;
    estimate.own_points += plan->own_points;
    estimate.halo_points += plan->near_points - std::min(plan->near_points, plan->own_points);
    largest = std::max(largest, op.bytes(*plan));
  }
  estimate.peak_bytes = 2 * largest;
  return estimate;
}

}  // namespace pss
