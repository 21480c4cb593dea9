#include "stream/passes/committer.h"

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
  const std::vector<EncodedBlock> blocks = encode(finished.part);
  finished.part.own = {};
  finished.part.rows = {};
  std::uint64_t bytes = 0;
  for (const EncodedBlock& block : blocks) bytes += block.bytes.capacity();
  finished.part.memory.shrink_to(bytes);
  on_memory_(false);
  times_.compressing += compressing.seconds();
  const Stopwatch writing;
  PSS_TRY(write(finished, blocks));
  times_.writing += writing.seconds();
  return {};
}

std::vector<EncodedBlock> Committer::encode(const Part& part) const {
  const Schema& schema = operator_.result_header().schema;
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

Result<void> Committer::write(FinishedPart& part, const std::vector<EncodedBlock>& blocks) {
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    PSS_TRY(writer_.append(blocks[b]));
    operator_.merge_note(note_, part.notes[b]);
  }
  if (!part.last_of_tile) return {};
  // Tiles share a sync: what is lost with the power is at most this much or this long.
  const auto now = Clock::now();
  const bool sync = writer_.unsynced_bytes() > kSyncBytes || now - last_sync_ > kSyncTime;
  if (sync) last_sync_ = now;
  return writer_.commit_tile(part.cell, part.part.range.tile,
                             {operator_.note_version(), std::exchange(note_, {})}, sync);
}

}  // namespace pss
