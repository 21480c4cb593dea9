#include "stream/sort/ingest.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <memory>
#include <utility>

#include "io/file/file.h"
#include "io/file/fingerprint.h"
#include "stream/limit/stopwatch.h"
#include "stream/sort/chunk.h"
#include "stream/sort/disk_need.h"
#include "stream/sort/encode_blocks.h"
#include "stream/sort/ingest_memory.h"
#include "stream/sort/input_stream.h"
#include "stream/sort/merge.h"
#include "stream/sort/run_log.h"
#include "stream/sort/tile_writer.h"

namespace pss {
namespace {

/// Merged into a longer run at once.
constexpr std::size_t kMergeBlocks = 16;
/// Read at once: the user sees how far it is, and threads seldom wait for the last batches.
constexpr std::size_t kReadAtOnce = 1 << 21;

std::string runs_folder(const std::string& work_dir) { return work_dir + "/runs"; }

/// The times of a run of the program are no part of what it makes.
std::string stored_summary(IngestSummary summary) {
  summary.read_seconds = 0;
  summary.merge_seconds = 0;
  return to_json(summary);
}

/// A run whose bytes are on their way to the disk.
struct WrittenRun {
  std::unique_ptr<RunWriter> file;
  RunInfo info;
  Cursor cursor;                    ///< all before it is in the runs
  IngestSummary summary;            ///< of all before the cursor
  std::vector<InputCounts> counts;  ///< the same of each input
  std::future<Result<void>> synced;
};

class Ingest {
 public:
  Ingest(const IngestPlan& plan, const std::string& store_path, const std::string& work_dir,
         const IngestOptions& options, MemoryBudget& budget, Monitor& monitor)
      : plan_(plan),
        store_path_(store_path),
        work_dir_(work_dir),
        options_(options),
        budget_(budget),
        monitor_(monitor) {}

  Result<IngestSummary> run() {
    if (is_store(store_path_)) {
      PSS_ASSIGN(StoreWriter store, StoreWriter::resume(store_path_, plan_.header));
      if (store.complete()) return finished(store);
      store_ = std::move(store);
    }
    PSS_ASSIGN(RunLog log, RunLog::open(runs_folder(work_dir_), plan_.header));
    log_ = std::move(log);
    PSS_ASSIGN(memory_, divide_memory(plan_.header, plan_.points, plan_.unit, budget_));
    PSS_TRY(check_heads());
    PSS_TRY(check_room());
    PSS_TRY(read_inputs());
    if (!done_) PSS_TRY(merge_runs());
    return finish();
  }

 private:
  const Schema& schema() const { return plan_.header.schema; }

  Result<IngestSummary> finished(const StoreWriter& store) const {
    PSS_TRY(remove_runs(runs_folder(work_dir_)));
    return ingest_summary_from_json(store.summary());
  }

  Result<Reservation> reserve(std::uint64_t bytes) {
    return budget_.take(bytes, "sorting the input");
  }

  /// What the input with the largest head takes beyond what is held for the first one's, while that
  /// head is copied to the store.
  std::uint64_t more_for_heads() const {
    if (plan_.head_sizes.empty()) return 0;
    const std::uint64_t largest = *std::ranges::max_element(plan_.head_sizes);
    return kHeadCopies * (largest - plan_.head_sizes.front());
  }

  /// Refuses before any point is read what could not be copied in the end.
  Result<void> check_heads() const {
    if (more_for_heads() <= budget_.available()) return {};
    const auto largest = std::ranges::max_element(plan_.head_sizes) - plan_.head_sizes.begin();
    return budget_.refusal(
        fmt::format("{}: its head", plan_.inputs[static_cast<std::size_t>(largest)].path),
        more_for_heads());
  }

  Result<void> check_room() {
    const IngestState& state = log_->state();
    const std::uint64_t stored = store_ ? store_->points() : 0;
    const auto left = [&](std::uint64_t done) {
      return plan_.points - std::min(plan_.points, done);
    };
    const bool short_path = state.runs.empty() && plan_.points <= memory_.chunk_points;
    const DiskWork work{short_path ? 0 : left(state.summary.points_read), left(stored),
                        memory_.chunk_points, options_.source_column};
    return check_disk(plan_, work, store_path_, work_dir_, monitor_);
  }

  /// Reads from the cursor to the end of the inputs, a run at a time.
  Result<void> read_inputs() {
    const IngestState& state = log_->state();
    if (state.cursor.input == plan_.inputs.size()) return {};
    const Stopwatch watch;
    const double seconds_before = state.summary.read_seconds;
    monitor_.begin("read", plan_.points);
    monitor_.advance(state.summary.points_read);
    PSS_ASSIGN(Reservation reservation, reserve(memory_.read_bytes));
    InputStream in(plan_, options_.source_column, state.cursor, state.summary, state.counts);
    Chunk chunk(memory_.chunk_points, schema().row_size());
    const Result<void> read = read_chunks(in, chunk, reservation, seconds_before, watch);
    PSS_TRY(settle_run());
    return read;
  }

  Result<void> read_chunks(InputStream& in, Chunk& chunk, Reservation& reservation,
                           double seconds_before, const Stopwatch& watch) {
    while (!in.ended()) {
      PSS_TRY(fill(in, chunk));
      PSS_TRY(chunk.sort(monitor_));
      PSS_TRY(settle_run());
      summary_ = in.summary();
      counts_ = in.counts();
      summary_.read_seconds = seconds_before + watch.seconds();
      if (in.ended() && log_->state().runs.empty()) {
        PSS_ASSIGN(done_, write_short(chunk, reservation));
        if (done_) return {};
      }
      // A run is resumed from: it is of the planned files, or it is not there.
      PSS_TRY(in.check_input());
      PSS_TRY(write_run(chunk, in.cursor(), seconds_before, watch));
      chunk.clear();
    }
    return {};
  }

  Result<void> fill(InputStream& in, Chunk& chunk) {
    while (!in.ended() && chunk.room() >= memory_.batches.points) {
      const std::uint64_t before = in.summary().points_read;
      const std::size_t most = std::max(kReadAtOnce, memory_.batches.points);
      PSS_TRY(in.read(std::min(chunk.room(), most), memory_.batches, chunk, monitor_));
      monitor_.advance(in.summary().points_read - before);
    }
    return {};
  }

  Result<void> check_stopping(const char* what) const {
    if (!monitor_.stopping()) return {};
    return Error{Fault::kInterrupted, fmt::format("stopped while {}", what)};
  }

  Result<void> write_run(const Chunk& chunk, const Cursor& cursor, double seconds_before,
                         const Stopwatch& watch) {
    PSS_ASSIGN(RunWriter run,
               RunWriter::create(log_->folder(), log_->state().next_id, options_.sync.early));
    std::size_t first = 0;
    PSS_TRY(encode_blocks(
        schema(), chunk.size(), kRunBlockPoints,
        [&](std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) {
          chunk.get(begin, positions, rows);
        },
        [&](const EncodedBlock& block) {
          const Key& key = chunk.key(first);
          first += block.count;
          return run.append(key, block);
        },
        monitor_));
    PSS_ASSIGN(const RunInfo info, run.finish());
    summary_.read_seconds = seconds_before + watch.seconds();
    // The disk writes while the next chunk is read.
    auto writer = std::make_unique<RunWriter>(std::move(run));
    auto synced = std::async(std::launch::async, [&file = *writer] { return file.sync(); });
    written_ = {std::move(writer), info, cursor, summary_, counts_, std::move(synced)};
    return {};
  }

  /// Waits until the run written last is durable, and records it.
  Result<void> settle_run() {
    if (!written_.synced.valid()) return {};
    PSS_TRY(written_.synced.get());
    written_.file.reset();
    return log_->add(written_.info, written_.cursor, written_.summary, written_.counts);
  }

  /// Everything fits in memory: straight to tiles. False where the tiles' buffers do not fit too.
  Result<bool> write_short(Chunk& chunk, Reservation& reservation) {
    chunk.end_sorting();
    const std::uint64_t held = memory_.chunk_points * Chunk::bytes_per_point(schema().row_size());
    reservation.release();
    const std::uint64_t needed = held + tile_writer_memory(plan_.header, chunk.size());
    auto both = budget_.reserve(needed);
    if (!both) {
      PSS_ASSIGN(reservation, reserve(memory_.read_bytes));
      return false;
    }
    PSS_TRY(open_store());
    ChunkStream stream(chunk, static_cast<std::size_t>(std::min<std::uint64_t>(
                                  resume_point(*store_).rows, chunk.size())));
    PSS_TRY(merge_into_tiles(stream, chunk.size()));
    return true;
  }

  Result<void> open_store() {
    if (store_) return {};
    PSS_ASSIGN(StoreWriter store, StoreWriter::create(store_path_, plan_.header));
    store_ = std::move(store);
    return {};
  }

  Result<void> merge_into_tiles(SortedStream& stream, std::uint64_t points) {
    const Stopwatch watch;
    monitor_.begin("merge", points);
    monitor_.advance(store_->points(), store_->tiles().size());
    PSS_TRY(write_tiles(stream, plan_.header, points, *store_, monitor_, options_.sync));
    summary_.merge_seconds += watch.seconds();
    return {};
  }

  Result<void> merge_runs() {
    summary_ = log_->state().summary;
    counts_ = log_->state().counts;
    PSS_ASSIGN(const Reservation reservation, reserve(memory_.merge_bytes));
    const auto& runs = log_->state().runs;
    const Stopwatch watch;
    while (runs.size() > memory_.fan_in)
      PSS_TRY(merge_some(std::min(memory_.fan_in, runs.size() - memory_.fan_in + 1)));
    summary_.merge_seconds = watch.seconds();
    PSS_TRY(open_store());
    PSS_ASSIGN(MergeStream stream, open_merge(runs, resume_point(*store_).key));
    std::uint64_t points = 0;
    for (const RunInfo& run : runs) points += run.points;
    return merge_into_tiles(stream, points);
  }

  Result<MergeStream> open_merge(std::span<const RunInfo> runs, const std::optional<Key>& from) {
    const std::uint64_t bytes = memory_.merge_bytes - memory_.tile_bytes;
    return MergeStream::open(log_->folder(), runs, schema(), from,
                             merge_run_points(schema(), runs.size(), bytes), monitor_);
  }

  /// One run from the first `count`: they are more than can be merged into tiles at once.
  Result<void> merge_some(std::size_t count) {
    const auto runs = std::span(log_->state().runs).first(count);
    std::uint64_t points = 0;
    for (const RunInfo& run : runs) points += run.points;
    monitor_.begin("merge runs", points);
    PSS_ASSIGN(MergeStream stream, open_merge(runs, std::nullopt));
    PSS_ASSIGN(RunWriter out,
               RunWriter::create(log_->folder(), log_->state().next_id, options_.sync.early));
    KeyedRows batch(kMergeBlocks * kRunBlockPoints, schema().row_size());
    for (;;) {
      PSS_TRY(check_stopping("merging runs"));
      PSS_ASSIGN(const std::size_t read, stream.read(batch.keys, batch.rows));
      if (read == 0) break;
      PSS_TRY(write_blocks(batch, read, out));
      monitor_.advance(read);
    }
    PSS_ASSIGN(const RunInfo info, out.finish());
    PSS_TRY(out.sync());
    return log_->replace(count, info);
  }

  Result<void> write_blocks(const KeyedRows& points, std::size_t count, RunWriter& out) {
    std::size_t first = 0;
    return encode_blocks(
        schema(), count, kRunBlockPoints,
        [&](std::size_t begin, std::span<Index3> positions, std::span<std::byte> rows) {
          const auto keys = std::span(points.keys).subspan(begin, positions.size());
          std::ranges::transform(keys, positions.begin(), decode_key);
          std::ranges::copy_n(points.row(begin), rows.size(), rows.begin());
        },
        [&](const EncodedBlock& block) {
          const Key& key = points.keys[first];
          first += block.count;
          return out.append(key, block);
        },
        monitor_);
  }

  Result<IngestSummary> finish() {
    summary_.points_stored = store_->points();
    summary_.spacing = plan_.spacing;
    if (summary_.points_read != summary_.points_stored + summary_.dropped())
      return Error{
          Fault::kFailed,
          fmt::format("{}: {} points stored, {} read and {} dropped; use --restart", store_path_,
                      summary_.points_stored, summary_.points_read, summary_.dropped())};
    PSS_TRY(write_inputs());
    PSS_TRY(check_unchanged(plan_.inputs));
    PSS_TRY(store_->finish(stored_summary(summary_)));
    PSS_TRY(remove_runs(runs_folder(work_dir_)));
    return summary_;
  }

  /// What the store keeps of every input; one head at a time is in memory.
  Result<void> write_inputs() {
    if (plan_.inputs.empty()) return {};
    PSS_ASSIGN(const Reservation memory, reserve(more_for_heads()));
    PSS_ASSIGN(InputTableWriter table, InputTableWriter::create(store_path_, plan_.inputs.size()));
    for (std::size_t i = 0; i < plan_.inputs.size(); ++i) {
      PSS_TRY(check_stopping("copying the heads of the inputs"));
      PSS_TRY(write_input(i, table));
    }
    return table.finish();
  }

  Result<void> write_input(std::size_t number, InputTableWriter& table) const {
    const InputRecord& record = plan_.inputs[number];
    PSS_ASSIGN(const auto reader, plan_.open(record, HeadBytes::kKept, plan_.counts[number]));
    const CloudHeader& header = reader->header();
    return table.add({record, header.format, header.grid, counts_[number]}, header.crs,
                     header.carry);
  }

  const IngestPlan& plan_;
  const std::string& store_path_;
  const std::string& work_dir_;
  const IngestOptions& options_;
  MemoryBudget& budget_;
  Monitor& monitor_;
  IngestMemory memory_;
  std::optional<StoreWriter> store_;
  std::optional<RunLog> log_;
  WrittenRun written_;
  IngestSummary summary_;
  std::vector<InputCounts> counts_;  ///< what summary_ says, of each input
  bool done_ = false;                ///< all tiles are written, without any run
};

}  // namespace

Result<IngestSummary> ingest(const IngestPlan& plan, const std::string& store_path,
                             const std::string& work_dir, const IngestOptions& options,
                             MemoryBudget& budget, Monitor& monitor) {
  return Ingest(plan, store_path, work_dir, options, budget, monitor).run();
}

}  // namespace pss
