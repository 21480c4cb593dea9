#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace pss {

ThreadLimit::ThreadLimit(int count) {
  const std::size_t threads = count > 0 ? static_cast<std::size_t>(count)
                                        : std::max(1u, std::thread::hardware_concurrency());
  control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

int thread_count() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(
      Range(0, count, std::max<std::size_t>(grain, 1)),
      [&](const Range& range) { body(range.begin(), range.end()); }, tbb::simple_partitioner());
}

void parallel_in_order(std::size_t slots, const std::function<bool(std::size_t)>& take,
                       const std::function<void(std::size_t)>& work,
                       const std::function<bool(std::size_t)>& give) {
  using tbb::filter_mode;
  std::size_t next = 0;
  std::atomic<bool> ended = false;
  const auto first = [&](tbb::flow_control& flow) {
    if (ended || !take(next)) flow.stop();
    return next++;
  };
  const auto middle = [&](std::size_t k) { return work(k), k; };
  const auto last = [&](std::size_t k) {
    if (!ended && !give(k)) ended = true;
  };
  tbb::parallel_pipeline(
      slots, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, first) &
                 tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, middle) &
                 tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, last));
}

std::size_t slots_in_order() { return 2 * static_cast<std::size_t>(thread_count()); }

}  // namespace pss
