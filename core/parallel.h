#pragma once
// Loops over all threads; the one place that knows how they are run.

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

}  // namespace pss
