#include "stream/store/codec.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace pss {
namespace {

std::vector<std::byte> encoded(const std::vector<std::byte>& values, const ColumnShape& shape) {
  std::vector<std::byte> column;
  append_column(values.data(), shape, column);
  return column;
}

void expect_round_trip(const std::vector<std::byte>& values, const ColumnShape& shape) {
  const auto column = encoded(values, shape);
  EXPECT_LE(column.size(), column_bound(shape.bytes()));
  std::vector<std::byte> back(values.size());
  ASSERT_TRUE(decode_column(column, shape, back.data()));
  EXPECT_EQ(back, values);
}

std::vector<std::byte> random_bytes(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::byte> bytes(size);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random() & 0xff);
  return bytes;
}

TEST(Codec, GivesBackRandomValuesOfEveryWidth) {
  for (const std::size_t width : {1u, 2u, 4u, 8u})
    for (const std::size_t lanes : {1u, 3u})
      for (const bool delta : {false, true})
        for (const std::size_t count : {0u, 1u, 2u, 7u, 4096u})
          expect_round_trip(random_bytes(count * width * lanes, 11),
                            {count, lanes, width, width * lanes, delta});
}

TEST(Codec, GivesBackTheExtremesOfEveryWidth) {
  std::vector<std::byte> values;
  for (int i = 0; i < 64; ++i) {
    const auto value = i % 3 == 0   ? std::numeric_limits<std::int64_t>::min()
                       : i % 3 == 1 ? std::numeric_limits<std::int64_t>::max()
                                    : std::int64_t{-1};
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    values.insert(values.end(), bytes, bytes + sizeof value);
  }
  for (const std::size_t width : {1u, 2u, 4u, 8u})
    expect_round_trip(values, {values.size() / width, 1, width, width, true});
}

TEST(Codec, MakesConstantAndSteadilyGrowingColumnsTiny) {
  std::vector<std::uint32_t> steady(4096);
  for (std::size_t i = 0; i < steady.size(); ++i) steady[i] = static_cast<std::uint32_t>(7 * i);
  std::vector<std::byte> column;

  append_column(reinterpret_cast<const std::byte*>(steady.data()), {4096, 1, 4, 4, true}, column);

  EXPECT_LT(column.size(), 200u);
}

TEST(Codec, TakesOnlyItsOwnBytesOfARow) {
  const auto rows = random_bytes(100 * 10, 3);
  const ColumnShape shape{100, 1, 4, 10, true};
  std::vector<std::byte> column;
  append_column(rows.data() + 2, shape, column);
  std::vector<std::byte> back(rows.size(), std::byte{0xee});

  ASSERT_TRUE(decode_column(column, shape, back.data() + 2));

  for (std::size_t i = 0; i < 100; ++i)
    for (std::size_t b = 0; b < 10; ++b)
      EXPECT_EQ(back[i * 10 + b], b >= 2 && b < 6 ? rows[i * 10 + b] : std::byte{0xee});
}

TEST(Codec, RefusesOrDecodesEveryTruncationAndBitFlipWithoutHarm) {
  std::vector<std::byte> values(300 * 4);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::byte>(i / 40);
  const ColumnShape shape{300, 1, 4, 4, true};
  const auto column = encoded(values, shape);
  std::vector<std::byte> out(values.size());
  for (std::size_t size = 0; size < column.size(); ++size)
    EXPECT_FALSE(decode_column(std::span(column).first(size), shape, out.data())) << size;

  auto flipped = column;
  for (std::size_t bit = 0; bit < 8 * column.size(); ++bit) {
    flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    const bool decoded = decode_column(flipped, shape, out.data());
    EXPECT_TRUE(bit >= 8 || !decoded || out != values) << bit;
    flipped[bit / 8] = column[bit / 8];
  }
}

TEST(Codec, RefusesRandomBytesOfAnyLengthOrDecodesThemWithinBounds) {
  const ColumnShape shape{50, 3, 2, 6, false};
  std::vector<std::byte> out(300);
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    auto garbage = random_bytes(seed % 400, seed);
    if (!garbage.empty()) garbage[0] &= std::byte{3};
    refused += decode_column(garbage, shape, out.data()) ? 0 : 1;
  }
  EXPECT_GT(refused, 1900);
}

}  // namespace
}  // namespace pss
