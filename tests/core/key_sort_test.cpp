#include "core/key_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "core/parallel.h"

namespace pss {
namespace {

constexpr std::uint64_t kWord = ~std::uint64_t{0} >> 1;
constexpr Key kLast{kWord, kWord};

/// The keys' numbers in order, by std::sort.
std::vector<std::uint32_t> order_by_comparison(const std::vector<Key>& keys, const TieBreak& tie) {
  std::vector<std::uint32_t> order(keys.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    if (keys[a] != keys[b]) return keys[a] < keys[b];
    return tie ? tie(a, b) : a < b;
  });
  return order;
}

std::vector<std::uint32_t> order_by_radix(const std::vector<Key>& keys, const TieBreak& tie) {
  std::vector<KeyEntry> entries(keys.size()), scratch(keys.size());
  EXPECT_TRUE(sort_keys(keys, entries, scratch, tie));
  std::vector<std::uint32_t> order;
  for (const KeyEntry& e : entries) order.push_back(e.index);
  return order;
}

/// Keys that are hard on a radix sort, each kind from its own seed.
std::vector<Key> make_keys(const std::string& kind, std::size_t count) {
  std::mt19937_64 random(42);
  std::vector<Key> keys(count);
  for (std::size_t i = 0; i < count; ++i) {
    Key& k = keys[i];
    const std::uint64_t r = random();
    if (kind == "any") k = {r & kWord, random() & kWord};
    if (kind == "all equal") k = {5, 5};
    if (kind == "lowest bit") k = {kWord, kWord - r % 2};
    if (kind == "highest bit") k = {(r % 2) << 62, 7};
    if (kind == "highest and lowest bit") k = {(r % 2) << 62, r / 2 % 2};
    if (kind == "a narrow range") k = {7, r % 1000};
    if (kind == "both sides of the words' border") k = {r % 4, (random() % 4) << 61};
    if (kind == "long equal ranges") k = {r % 7 << 40, random() % 3};
    if (kind == "one corner and far outliers")
      k = r % 1000 == 0 ? Key{random() & kWord, random() & kWord} : Key{0, random() % 300000};
    if (kind == "each bit alone")
      k = r % 126 < 63 ? Key{0, 1ull << r % 63} : Key{1ull << r % 63, 0};
    if (kind == "sorted") k = {i / 1000, i % 1000 / 2};
    if (kind == "reversed") k = {kLast.high - i / 1000, kLast.low - i % 1000 / 2};
    if (kind == "sorted but the last") k = i + 1 < count ? Key{1, i} : Key{0, 0};
  }
  return keys;
}

class KeySort : public testing::TestWithParam<const char*> {};

TEST_P(KeySort, AgreesWithComparisonForAnyNumberOfKeysAndThreads) {
  for (const std::size_t count : {0u, 1u, 2u, 24u, 25u, 700u, 65536u, 65537u, 200000u}) {
    const std::vector<Key> keys = make_keys(GetParam(), count);
    const TieBreak backwards = [](std::uint32_t a, std::uint32_t b) { return a > b; };
    const auto expected = order_by_comparison(keys, backwards);
    for (const int threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      EXPECT_TRUE(order_by_radix(keys, backwards) == expected) << count << ' ' << threads;
    }
  }
}

TEST_P(KeySort, OrdersEqualKeysByTheirNumbersWhereNothingElseDecides) {
  const std::vector<Key> keys = make_keys(GetParam(), 70000);

  EXPECT_TRUE(order_by_radix(keys, nullptr) == order_by_comparison(keys, nullptr));
}

INSTANTIATE_TEST_SUITE_P(Keys, KeySort,
                         testing::Values("any", "all equal", "lowest bit", "highest bit",
                                         "highest and lowest bit", "a narrow range",
                                         "both sides of the words' border", "long equal ranges",
                                         "one corner and far outliers", "each bit alone", "sorted",
                                         "reversed", "sorted but the last"),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::ranges::replace_if(
                               name, [](char c) { return c == ' ' || c == '\''; }, '_');
                           return name;
                         });

class StopAtOnce : public Monitor {
 public:
  bool stopping() const override { return true; }
};

TEST(KeySortStop, SaysThatItWasStopped) {
  const std::vector<Key> keys = make_keys("any", 100000);
  std::vector<KeyEntry> entries(keys.size()), scratch(keys.size());

  EXPECT_FALSE(sort_keys(keys, entries, scratch, nullptr, StopAtOnce()));
}

}  // namespace
}  // namespace pss
