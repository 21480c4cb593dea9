#include "stream/passes/scheduler.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "stream/limit/stopwatch.h"
#include "stream/passes/committer.h"
#include "stream/passes/part_needs.h"
#include "stream/passes/part_source.h"
#include "stream/passes/read_ahead.h"

namespace pss {
namespace {

class Pipeline {
 public:
  Pipeline(const PassSources& sources, const Operator& op, StoreWriter& result,
           MemoryBudget& budget, Monitor& monitor)
      : source_(sources.queries),
        op_(op),
        monitor_(monitor),
        reader_(sources, op, budget, monitor, result.next_source()),
        committer_(result, op, [this](bool done) { memory_came_back(done); }) {}

  Result<ScheduleSummary> run() {
    for (;;) {
      PSS_ASSIGN(std::optional<Part> part, reader_.next());
      if (!part) break;
      PSS_TRY(compute(std::move(*part)));
    }
    const Stopwatch watch;
    PSS_TRY(committer_.drain());
    summary_.wait_commit = watch.seconds();
    return summary();
  }

 private:
  void memory_came_back(bool done) {
    if (done)
      reader_.done();
    else
      reader_.memory_came_back();
  }

  Result<void> compute(Part part) {
    const Stopwatch watch;
    FinishedPart finished;
    const std::size_t points = part.own.size();  // which the operator may take over
    if (points > 0) finished.rows = op_.apply(part, monitor_);
    if (monitor_.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    const TileInfo& tile = source_.tiles()[part.range.tile];
    finished.cell = tile.cell;
    finished.tile = part.range.tile;
    finished.last_of_tile = part.range.first_block + part.range.block_count == tile.blocks;
    count(points, part.halo, finished.last_of_tile);
    finished.memory = std::move(part.memory);
    part = {};
    summary_.compute_seconds += watch.seconds();
    return committer_.push(std::move(finished));
  }

  void count(std::size_t points, std::uint64_t halo, bool last_of_tile) {
    ++summary_.parts;
    summary_.tiles += last_of_tile ? 1 : 0;
    summary_.own_points += points;
    summary_.halo_points += halo;
    monitor_.advance(0, last_of_tile ? 1 : 0);
  }

  ScheduleSummary summary() const {
    ScheduleSummary summary = summary_;
    const ReadTimes read = reader_.times();
    const CommitTimes commit = committer_.times();
    summary.reloaded_parts = reader_.reloaded_parts();
    summary.load_seconds = read.loading;
    summary.wait_reading = read.compute_for_reading;
    summary.wait_memory = read.compute_for_memory;
    summary.wait_seconds = summary.wait_reading + summary.wait_memory + summary.wait_commit;
    summary.encode_seconds = commit.compressing;
    summary.write_seconds = commit.writing;
    return summary;
  }

  const Source& source_;
  const Operator& op_;
  Monitor& monitor_;
  ScheduleSummary summary_;
  ReadAhead reader_;
  Committer committer_;  ///< last: it tells the reader
};

}  // namespace

Result<ScheduleSummary> run_operator(const PassSources& sources, const Operator& op,
                                     StoreWriter& result, MemoryBudget& budget, Monitor& monitor) {
  const Stopwatch watch;
  const std::uint64_t resumed = result.tiles().size();
  PSS_ASSIGN(ScheduleSummary summary, Pipeline(sources, op, result, budget, monitor).run());
  summary.resumed_tiles = resumed;
  summary.seconds = watch.seconds();
  return summary;
}

Result<Note> merged_notes(const Operator& op, std::span<const TileInfo> tiles,
                          const std::string& store) {
  Note total{op.note_version(), {}};
  for (const TileInfo& tile : tiles) {
    PSS_ASSIGN(const std::span<const std::byte> bytes, bytes_of(tile.note, total.version, store));
    if (!bytes.empty()) op.merge_note(total.bytes, bytes);
  }
  return total;
}

Result<ScheduleEstimate> estimate_operator(const PassSources& sources, const Operator& op,
                                           MemoryBudget& budget) {
  const PartLoader loader(sources, op.needs());
  const Room room(budget);
  PartQueue queue(sources, 0);
  ScheduleEstimate estimate;
  estimate.tiles = sources.tiles ? sources.tiles->size() : sources.queries.tiles().size();
  std::uint64_t largest = 0;
  while (const std::optional<PartRange> range = queue.pop()) {
    PSS_ASSIGN(PartPlan plan, loader.plan(*range));
    plan.around = op.neighbourhood().around(plan);
    PSS_TRY(loader.plan_near(plan, most_candidates(room)));
    PSS_ASSIGN(const bool whole, fits(loader, op, plan, room));
    if (!whole) {
      queue.push_halves(*range);
      continue;
    }
    ++estimate.parts;
    estimate.own_points += plan.own_points;
    estimate.halo_points += plan.near_points - std::min(plan.near_points, plan.own_points);
    largest = std::max(largest, part_bytes(op, plan));
  }
  estimate.peak_bytes = 2 * largest;
  return estimate;
}

}  // namespace pss
