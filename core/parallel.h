#pragma once
// Loops and pipelines over all threads; the one place that knows how they are run.

#include <cstddef>
#include <functional>

namespace pss {

/// Caps the threads that parallel_for uses while it lives.
///
/// `count` 0 means all that the machine has.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

/// The number of threads that parallel_for uses now.
int thread_count();

/// Calls `body(begin, end)` on consecutive ranges that cover [0, count), in any order, in parallel.
///
/// Requires: `body` throws nothing and waits for nothing but the processor.
/// Thread:   ranges hold at most `grain` items; which thread runs which is not determined.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

/// Passes pieces 0, 1, 2, ... through three steps, until `take` or `give` returns false.
///
/// take(k) prepares a piece and give(k) hands it on, each for one piece after the other, in order;
/// work(k) is done on many pieces at once. Piece k may use what piece k - `slots` used: that one
/// has been given. What was taken is worked on; after a false `give` nothing is given any more.
///
/// Requires: they throw nothing. `take` and `give` may wait for the disk: the other threads go on
///           meanwhile, as far as `slots` pieces reach.
/// Thread:   `take` and `give` by any, and possibly at once.
void parallel_in_order(std::size_t slots, const std::function<bool(std::size_t)>& take,
                       const std::function<void(std::size_t)>& work,
                       const std::function<bool(std::size_t)>& give);

/// So many slots keep all threads busy while pieces take unequal time.
std::size_t slots_in_order();

}  // namespace pss
