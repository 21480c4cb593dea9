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

TEST(ParallelInOrder, WorksOnEveryPieceOnceAndGivesThemInOrder) {
  for (const std::size_t count : {0, 1, 5, 1000})
    for (const std::size_t slots : {1, 2, 7}) {
      std::vector<std::size_t> slot(slots);
      std::vector<std::size_t> given;
      parallel_in_order(
          slots, [&](std::size_t k) { return slot[k % slots] = k, k < count; },
          [&](std::size_t k) { slot[k % slots] += 1000000; },
          [&](std::size_t k) { return given.push_back(slot[k % slots]), true; });
      ASSERT_EQ(given.size(), count);
      for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(given[k], k + 1000000);
    }
}

TEST(ParallelInOrder, EndsAfterThePieceThatIsRefused) {
  std::atomic<std::size_t> taken = 0;
  std::size_t given = 0;
  parallel_in_order(
      4, [&](std::size_t) { return ++taken, true; }, [](std::size_t) {},
      [&](std::size_t k) { return ++given, k < 10; });
  EXPECT_EQ(given, 11u);
  EXPECT_LE(taken, 11u + 4u);
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
