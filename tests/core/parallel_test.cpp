#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace pss::test {
namespace {

TEST(ParallelFor, VisitsEveryItemOnceInRangesWithinTheGrain) {
  for (const std::size_t count : {0, 1, 7, 1000, 12345})
    for (const std::size_t grain : {0, 1, 64, 100000}) {
      std::vector<std::atomic<int>> visits(count);
      std::atomic<bool> too_long = false;
      parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        if (end - begin > std::max<std::size_t>(grain, 1)) too_long = true;
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_FALSE(too_long);
      for (const std::atomic<int>& v : visits) ASSERT_EQ(v, 1);
    }
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const int before = thread_count();
  {
    const ThreadLimit one(1);
    EXPECT_EQ(thread_count(), 1);
    std::atomic<int> running = 0;
    std::atomic<int> most = 0;
    parallel_for(200, 1, [&](std::size_t, std::size_t) {
      const int now = ++running;
      if (now > most) most = now;
      --running;
    });
    EXPECT_EQ(most, 1);
  }
  EXPECT_EQ(thread_count(), before);
}

}  // namespace
}  // namespace pss::test
