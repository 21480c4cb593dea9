#include "stream/sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "core/parallel.h"
#include "stream/keyed_rows.h"

namespace pss {
namespace {

constexpr std::size_t kRow = 3;

/// Sorts by both ways and compares keys and rows in order.
void expect_sorted(std::vector<SortEntry> entries, const std::vector<std::byte>& rows) {
  std::vector<SortEntry> expected = entries;
  std::ranges::sort(expected, [&](const SortEntry& a, const SortEntry& b) {
    return before(a.key, &rows[a.row * kRow], b.key, &rows[b.row * kRow], kRow);
  });
  std::vector<SortEntry> scratch(entries.size());

  ASSERT_TRUE(sort_entries(entries, scratch, rows.data(), kRow, Monitor()));

  for (std::size_t i = 0; i < entries.size(); ++i) {
    ASSERT_EQ(entries[i].key, expected[i].key) << i;
    ASSERT_EQ(std::memcmp(&rows[entries[i].row * kRow], &rows[expected[i].row * kRow], kRow), 0);
  }
}

template <class MakeKey>
void expect_sorts(std::size_t count, const MakeKey& make_key) {
  std::mt19937_64 random(42);
  std::vector<SortEntry> entries;
  std::vector<std::byte> rows;
  for (std::size_t i = 0; i < count; ++i) {
    entries.push_back({make_key(random), static_cast<std::uint32_t>(i)});
    for (std::size_t b = 0; b < kRow; ++b) rows.push_back(static_cast<std::byte>(random() % 5));
  }
  expect_sorted(entries, rows);
}

constexpr std::uint64_t kWord = ~std::uint64_t{0} >> 1;

TEST(Sort, AgreesWithComparisonForKeysOfAnyWidth) {
  for (const std::size_t count : {0u, 1u, 2u, 500u, 70000u, 200000u}) {
    expect_sorts(count, [](auto& r) { return Key{r() & kWord, r() & kWord}; });
    expect_sorts(count, [](auto& r) { return Key{7, r() % 1000}; });
    expect_sorts(count, [](auto& r) { return Key{r() % 4, (r() % 4) << 61}; });
  }
}

TEST(Sort, AgreesWithComparisonWhereNearlyAllPointsAreInOneCorner) {
  expect_sorts(150000, [](auto& r) {
    return r() % 1000 == 0 ? Key{r() & kWord, r() & kWord} : Key{0, r() % 256};
  });
}

TEST(Sort, OrdersPointsOfOneKeyByTheirRows) {
  expect_sorts(100000, [](auto&) { return Key{5, 5}; });
}

TEST(Sort, GivesTheSameWithOneThread) {
  const ThreadLimit limit(1);
  expect_sorts(100000, [](auto& r) { return Key{r() & 15, r() & kWord}; });
}

class StopAtOnce : public Monitor {
 public:
  bool stopping() const override { return true; }
};

TEST(Sort, SaysThatItWasStopped) {
  std::vector<SortEntry> entries(100000);
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].key.low = i * 7919 % 100000;
  std::vector<SortEntry> scratch(entries.size());

  EXPECT_FALSE(sort_entries(entries, scratch, nullptr, 0, StopAtOnce()));
}

}  // namespace
}  // namespace pss
