#pragma once
// Loads parts on a thread of its own, ahead of whoever computes them.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/passes/part_source.h"

namespace pss {

/// What the reader and those who wait for it spent their time with, in seconds.
struct ReadTimes {
  double loading = 0;              ///< reading, sorting and preparing parts
  double waiting_for_memory = 0;   ///< the reader, until others gave some back
  double compute_for_reading = 0;  ///< compute, until a part was loaded
  double compute_for_memory = 0;   ///< compute, while the reader waited for memory
};

/// Some parts ahead, as far as the memory limit lets it.
class ReadAhead {
 public:
  ReadAhead(const PassSources& sources, const Operator& op, MemoryBudget& budget,
            const Monitor& monitor, std::size_t first_tile);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// The next part; empty at the end.
  ///
  /// Thread: one. Every part that it gives must be told to done() in the end.
  /// Errors: those of PartSource::next; kInterrupted.
  Result<std::optional<Part>> next();

  /// A part has given back some memory, or all of it.
  ///
  /// Thread: any.
  void memory_came_back();
  void done();

  /// Requires: next() gave the end.
  ReadTimes times() const { return times_; }
  std::uint64_t reloaded_parts() const { return source_.reloaded_parts(); }

 private:
  static constexpr std::size_t kMostReady = 2;

  void run();
  bool take(Reservation& memory, std::uint64_t bytes);
  bool wait_for_room();
  bool stopping() const { return ending_ || monitor_.stopping(); }

  MemoryBudget& budget_;
  const Monitor& monitor_;
  PartSource source_;
  ReadTimes times_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Part> ready_;
  std::size_t in_flight_ = 0;  ///< given by next() and not done
  std::uint64_t returns_ = 0;  ///< how often memory came back
  bool ended_ = false;
  std::atomic<bool> ending_ = false;
  std::optional<Error> error_;
  std::thread thread_;
};

}  // namespace pss
