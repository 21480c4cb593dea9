#include "stream/passes/read_ahead.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "stream/limit/stopwatch.h"

namespace pss {
namespace {

/// How soon a stop is noticed by one who waits.
constexpr std::chrono::milliseconds kLook{100};

}  // namespace

ReadAhead::ReadAhead(const PassSources& sources, const Operator& op, MemoryBudget& budget,
                     const Monitor& monitor, std::size_t first_tile)
    : budget_(budget),
      monitor_(monitor),
      source_(sources, op, budget, first_tile,
              [this](Reservation& memory, std::uint64_t bytes) { return take(memory, bytes); }),
      thread_([this] { run(); }) {}

ReadAhead::~ReadAhead() {
  ending_ = true;
  {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  }
  thread_.join();
}

void ReadAhead::run() {
  while (wait_for_room()) {
    const double waited = times_.waiting_for_memory;
    const Stopwatch watch;
    Result<std::optional<Part>> part = source_.next();
    const std::lock_guard lock(mutex_);
    times_.loading += watch.seconds() - (times_.waiting_for_memory - waited);
    if (part && *part)
      ready_.push_back(std::move(**part));
    else
      ended_ = true;
    if (!part) error_ = std::move(part).error();
    changed_.notify_all();
    if (ended_) return;
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  error_ = Error{Fault::kInterrupted, "interrupted"};
  changed_.notify_all();
}

/// False where the reader is to stop.
bool ReadAhead::wait_for_room() {
  std::unique_lock lock(mutex_);
  while (ready_.size() >= kMostReady && !stopping()) changed_.wait_for(lock, kLook);
  return !stopping();
}

bool ReadAhead::take(Reservation& memory, std::uint64_t bytes) {
  std::unique_lock lock(mutex_);
  for (;;) {
    const std::uint64_t seen = returns_;
    lock.unlock();
    if (budget_.grow(memory, bytes)) return true;
    lock.lock();
    if (seen != returns_) continue;
    if ((in_flight_ == 0 && ready_.empty()) || stopping()) return false;
    const Stopwatch watch;
    changed_.wait_for(lock, kLook);
    times_.waiting_for_memory += watch.seconds();
  }
}

Result<std::optional<Part>> ReadAhead::next() {
  const Stopwatch watch;
  std::unique_lock lock(mutex_);
  const double before = times_.waiting_for_memory;
  changed_.wait(lock, [this] { return ended_ || !ready_.empty(); });
  const double waited = watch.seconds();
  const double for_memory = std::min(waited, times_.waiting_for_memory - before);
  times_.compute_for_memory += for_memory;
  times_.compute_for_reading += waited - for_memory;
  // A reader that was told to stop may have found other reasons to end.
  if (monitor_.stopping()) return Error{Fault::kInterrupted, "interrupted"};
  if (ready_.empty()) return error_ ? Result<std::optional<Part>>(*error_) : std::optional<Part>();
  std::optional<Part> part(std::move(ready_.front()));
  ready_.pop_front();
  ++in_flight_;
  changed_.notify_all();
  return part;
}

void ReadAhead::memory_came_back() {
  const std::lock_guard lock(mutex_);
  ++returns_;
  changed_.notify_all();
}

void ReadAhead::done() {
  const std::lock_guard lock(mutex_);
  ++returns_;
  --in_flight_;
  changed_.notify_all();
}

}  // namespace pss
