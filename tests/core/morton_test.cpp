#include "core/morton.h"

#include <gtest/gtest.h>

#include "tests/support/cloud.h"

namespace pss::test {
namespace {

Index3 random_index(Random& random) {
  return {random.integer(kLatticeMin, kLatticeMax), random.integer(kLatticeMin, kLatticeMax),
          random.integer(kLatticeMin, kLatticeMax)};
}

/// Bit `bit` of 126, 0 the lowest.
bool key_bit(const Key& key, int bit) {
  return (bit < 63 ? key.low >> bit : key.high >> (bit - 63)) & 1;
}

/// The highest axis bit that differs decides, z before y before x: the order by its definition.
bool comes_before(const Index3& a, const Index3& b) {
  for (int bit = kLatticeBits - 1; bit >= 0; --bit)
    for (std::size_t axis = 3; axis-- > 0;) {
      const auto bit_of = [&](const Index3& p) { return ((p[axis] - kLatticeMin) >> bit) & 1; };
      if (bit_of(a) != bit_of(b)) return bit_of(a) < bit_of(b);
    }
  return false;
}

TEST(Morton, InterleavesTheBitsOfTheAxesWithXLowest) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Index3 index = random_index(random);
    const Key key = encode_key(index);
    for (int bit = 0; bit < 3 * kLatticeBits; ++bit) {
      const auto biased = index[static_cast<std::size_t>(bit % 3)] - kLatticeMin;
      EXPECT_EQ(key_bit(key, bit), (biased >> (bit / 3)) & 1);
    }
  }
}

TEST(Morton, DecodesWhatItEncodes) {
  Random random(2);
  std::vector<Index3> indices{{0, 0, 0},
                              {kLatticeMin, kLatticeMin, kLatticeMin},
                              {kLatticeMax, kLatticeMax, kLatticeMax},
                              {-1, 0, 1}};
  for (int i = 0; i < 2000; ++i) indices.push_back(random_index(random));
  for (const Index3& index : indices) EXPECT_EQ(decode_key(encode_key(index)), index);
}

TEST(Morton, OrdersByTheHighestDifferingBit) {
  Random random(3);
  for (int i = 0; i < 3000; ++i) {
    const Index3 a = random_index(random);
    Index3 b = a;  // often near each other
    for (std::int64_t& c : b) c = std::clamp(c + random.integer(-5, 5), kLatticeMin, kLatticeMax);
    for (const Index3& other : {b, random_index(random)})
      EXPECT_EQ(encode_key(a) < encode_key(other), comes_before(a, other));
  }
}

TEST(Cell, HoldsExactlyTheKeysOfItsCube) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Index3 p = random_index(random);
    const int level = static_cast<int>(random.integer(0, kLatticeBits));
    const int shift = kLatticeBits - level;
    const Cell cell = cell_of(encode_key(p), level);
    Index3 other = p;
    const std::int64_t spread = std::int64_t{1} << std::min(shift, 40);
    for (std::int64_t& c : other)
      c = std::clamp(c + random.integer(-spread, spread), kLatticeMin, kLatticeMax);
    bool in_cube = true;
    for (std::size_t a = 0; a < 3; ++a)
      in_cube &= ((other[a] - kLatticeMin) >> shift) == ((p[a] - kLatticeMin) >> shift);
    EXPECT_EQ(contains(cell, encode_key(other)), in_cube);
    EXPECT_TRUE(contains(cell, encode_key(p)));
  }
}

TEST(Cell, RunsFromItsLowestToItsHighestCorner) {
  const Index3 p{12345, -678, 0};
  for (int level = 0; level <= kLatticeBits; ++level) {
    const Cell cell = cell_of(encode_key(p), level);
    const Index3 low = decode_key(cell.first);
    const Index3 high = decode_key(last_key(cell));
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_EQ(high[a] - low[a], (std::int64_t{1} << (kLatticeBits - level)) - 1);
      EXPECT_LE(low[a], p[a]);
      EXPECT_GE(high[a], p[a]);
    }
  }
}

TEST(CommonLevel, IsTheDeepestLevelWhoseCellHoldsBoth) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const Index3 p = random_index(random);
    Index3 q = p;
    const std::int64_t spread = std::int64_t{1} << random.integer(0, 40);
    for (std::int64_t& c : q)
      c = std::clamp(c + random.integer(-spread, spread), kLatticeMin, kLatticeMax);
    const Key a = encode_key(p);
    const Key b = encode_key(q);
    const int level = common_level(a, b);
    EXPECT_EQ(cell_of(a, level), cell_of(b, level));
    if (level < kLatticeBits) {
      EXPECT_NE(cell_of(a, level + 1), cell_of(b, level + 1));
    }
  }
  EXPECT_EQ(common_level(encode_key({1, 2, 3}), encode_key({1, 2, 3})), kLatticeBits);
  EXPECT_EQ(common_level(encode_key({-1, 0, 0}), encode_key({0, 0, 0})), 0);
}

}  // namespace
}  // namespace pss::test
