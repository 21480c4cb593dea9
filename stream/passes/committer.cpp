#include "stream/passes/committer.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "stream/limit/stopwatch.h"

namespace pss {
namespace {

constexpr std::uint64_t kSyncBytes = 256u << 20;
constexpr std::chrono::seconds kSyncTime{2};

}  // namespace

Committer::Committer(StoreWriter& writer, const Operator& op,
                     std::function<void(bool done)> on_memory)
    : writer_(writer),
      operator_(op),
      on_memory_(std::move(on_memory)),
      thread_([this] { run(); }) {}

Committer::~Committer() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
  // Tiles that are finished count, also when the run is not. A failure is the writer's from here
  // on: it says so at the next call, if there is one.
  if (!error_) static_cast<void>(writer_.sync().has_value());
}

Result<void> Committer::failure_locked() const {
  if (error_) return *error_;
  return {};
}

Result<void> Committer::push(FinishedPart part) {
  const std::lock_guard lock(mutex_);
  PSS_TRY(failure_locked());
  queue_.push_back(std::move(part));
  changed_.notify_all();
  return {};
}

Result<void> Committer::drain() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return error_ || (queue_.empty() && !busy_); });
  return failure_locked();
}

void Committer::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ending_ || !queue_.empty(); });
    if (queue_.empty()) return;
    FinishedPart part = std::move(queue_.front());
    queue_.pop_front();
    busy_ = true;
    lock.unlock();
    Result<void> done = commit(part);
    part = {};  // its memory goes back before anyone hears that it is done
    on_memory_(true);
    lock.lock();
    busy_ = false;
    if (!done) {
      error_ = std::move(done).error();
      queue_.clear();
      changed_.notify_all();
      return;
    }
    changed_.notify_all();
  }
}

Result<void> Committer::commit(FinishedPart& finished) {
  const Stopwatch compressing;
  Rows rows = with_waiting(std::move(finished.rows));
  const std::size_t count = count_of(rows);
  const std::size_t encoded = finished.last_of_tile ? count : count - count % kBlockPoints;
  const std::vector<EncodedBlock> blocks = encode(rows, encoded);
  waiting_ = rows_from(rows, encoded);
  finished.rows.notes = std::move(rows.notes);
  rows = {};
  const std::uint64_t waiting =
      waiting_.positions.capacity() * sizeof(Index3) + waiting_.bytes.capacity();
  std::uint64_t bytes = waiting;
  for (const EncodedBlock& block : blocks) bytes += block.bytes.capacity();
  finished.memory.shrink_to(bytes);
  on_memory_(false);
  times_.compressing += compressing.seconds();
  const Stopwatch writing;
  PSS_TRY(write(finished, blocks));
  finished.memory.shrink_to(waiting);
  waiting_memory_ = std::move(finished.memory);
  times_.writing += writing.seconds();
  return {};
}

std::size_t Committer::count_of(const Rows& rows) const {
  if (!operator_.columns_alone()) return rows.positions.size();
  const std::size_t size = operator_.result_header().schema.row_size();
  return size == 0 ? 0 : rows.bytes.size() / size;
}

/// The rows of the tile that wait for a block, and those after them.
Rows Committer::with_waiting(Rows rows) {
  if (count_of(waiting_) == 0) return rows;
  Rows all = std::exchange(waiting_, {});
  all.positions.insert(all.positions.end(), rows.positions.begin(), rows.positions.end());
  all.bytes.insert(all.bytes.end(), rows.bytes.begin(), rows.bytes.end());
  all.notes = std::move(rows.notes);
  return all;
}

/// A copy of the rows from `first` on, without notes.
Rows Committer::rows_from(const Rows& rows, std::size_t first) const {
  const auto byte =
      static_cast<std::ptrdiff_t>(first * operator_.result_header().schema.row_size());
  Rows rest;
  if (!operator_.columns_alone())
    rest.positions.assign(rows.positions.begin() + static_cast<std::ptrdiff_t>(first),
                          rows.positions.end());
  rest.bytes.assign(rows.bytes.begin() + byte, rows.bytes.end());
  return rest;
}

std::vector<EncodedBlock> Committer::encode(const Rows& rows, std::size_t count) const {
  std::vector<EncodedBlock> blocks((count + kBlockPoints - 1) / kBlockPoints);
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t first = b * kBlockPoints;
      blocks[b] = encode(rows, first, std::min<std::size_t>(kBlockPoints, count - first));
    }
  });
  return blocks;
}

/// Columns alone stand at the lattice's origin, which takes next to nothing.
EncodedBlock Committer::encode(const Rows& rows, std::size_t first, std::size_t count) const {
  const Schema& schema = operator_.result_header().schema;
  const auto bytes =
      std::span(rows.bytes).subspan(first * schema.row_size(), count * schema.row_size());
  if (operator_.columns_alone()) {
    const std::vector<Index3> origins(count, Index3{});
    return encode_block(schema, origins, bytes);
  }
  return encode_block(schema, std::span(rows.positions).subspan(first, count), bytes);
}

Result<void> Committer::write(FinishedPart& part, const std::vector<EncodedBlock>& blocks) {
  for (const EncodedBlock& block : blocks) PSS_TRY(writer_.append(block));
  for (const auto& note : part.rows.notes) operator_.merge_note(note_, note);
  if (!part.last_of_tile) return {};
  // Tiles share a sync: what is lost with the power is at most this much or this long.
  const auto now = Clock::now();
  const bool sync = writer_.unsynced_bytes() > kSyncBytes || now - last_sync_ > kSyncTime;
  if (sync) last_sync_ = now;
  return writer_.commit_tile(part.cell, part.tile,
                             {operator_.note_version(), std::exchange(note_, {})}, sync);
}

}  // namespace pss
