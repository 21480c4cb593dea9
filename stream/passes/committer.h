#pragma once
// Compresses finished parts and writes them to the result store on a thread of its own, in order.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/result.h"
#include "stream/limit/memory.h"
#include "stream/passes/operator.h"
#include "stream/store/store.h"

namespace pss {

/// A computed part.
struct FinishedPart {
  Cell cell;
  std::size_t tile = 0;  ///< of the source
  bool last_of_tile = false;
  Rows rows;
  Reservation memory;
};

/// What committing took, in seconds.
struct CommitTimes {
  double compressing = 0;
  double writing = 0;
};

/// Compresses parts, appends them to a store in the order given, and commits each tile with its
/// last part. A tile's rows are cut into blocks of kBlockPoints, however they came in parts.
///
/// Destroyed before everything is drained, it still writes what is queued: finished tiles count.
class Committer {
 public:
  /// `on_memory(done)` is told when a part has given back some memory, and when it is done.
  Committer(StoreWriter& writer, const Operator& op, std::function<void(bool done)> on_memory);
  ~Committer();
  Committer(const Committer&) = delete;
  Committer& operator=(const Committer&) = delete;

  /// Queues a part. Errors: the first failure of the thread, which then writes nothing more.
  Result<void> push(FinishedPart part);
  /// Waits until everything queued is in the store.
  Result<void> drain();
  /// Requires: drained.
  CommitTimes times() const { return times_; }

 private:
  using Clock = std::chrono::steady_clock;
  void run();
  Result<void> commit(FinishedPart& part);
  Result<void> write(FinishedPart& part, const std::vector<EncodedBlock>& blocks);
  Rows with_waiting(Rows rows);
  std::vector<EncodedBlock> encode(const Rows& rows, std::size_t count) const;
  EncodedBlock encode(const Rows& rows, std::size_t first, std::size_t count) const;
  std::size_t count_of(const Rows& rows) const;
  Rows rows_from(const Rows& rows, std::size_t first) const;
  Result<void> failure_locked() const;

  StoreWriter& writer_;
  const Operator& operator_;
  std::function<void(bool)> on_memory_;
  CommitTimes times_;
  Clock::time_point last_sync_ = Clock::now();
  std::vector<std::byte> note_;  ///< of the tile that is being written
  Rows waiting_;                 ///< of that tile, too few for a block
  Reservation waiting_memory_;   ///< for these
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<FinishedPart> queue_;
  bool busy_ = false;
  bool ending_ = false;
  std::optional<Error> error_;
  std::thread thread_;
};

}  // namespace pss
