#include "stream/store/block.h"

#include <gtest/gtest.h>

#include <limits>

#include "io/file/hash.h"
#include "tests/stream/store_fixture.h"

namespace pss {
namespace {

std::span<const std::byte> column_of(const EncodedBlock& block, std::size_t c) {
  return std::span(block.bytes).subspan(block.columns[c].offset, block.columns[c].size);
}

void expect_round_trip(const Schema& schema, const test::Cloud& cloud) {
  const EncodedBlock block = encode_block(schema, cloud.positions, cloud.rows);

  ASSERT_EQ(block.count, cloud.positions.size());
  ASSERT_EQ(block.columns.size(), 1 + schema.fields().size());
  EXPECT_EQ(block.columns.back().offset + block.columns.back().size, block.bytes.size());
  EXPECT_LE(block.bytes.capacity(), encode_bytes(schema, block.count));
  std::vector<Index3> positions(block.count);
  ASSERT_TRUE(decode_positions(column_of(block, 0), positions));
  EXPECT_EQ(positions, cloud.positions);
  std::vector<std::byte> rows(cloud.rows.size());
  for (std::size_t f = 0; f < schema.fields().size(); ++f) {
    EXPECT_EQ(block.columns[1 + f].hash, hash64(column_of(block, 1 + f)));
    EXPECT_LE(block.columns[1 + f].size, column_limit(schema, 1 + f, block.count));
    ASSERT_TRUE(decode_field(schema.fields()[f], column_of(block, 1 + f), block.count,
                             rows.data() + schema.position(f), schema.row_size()));
  }
  EXPECT_EQ(rows, cloud.rows);
}

TEST(Block, GivesBackRandomRowsAtEveryExtent) {
  const Schema schema = test::rich_schema();
  for (const std::int64_t extent : {std::int64_t{1}, std::int64_t{1000}, std::int64_t{1} << 31,
                                    (std::int64_t{1} << 31) + 1, std::int64_t{1} << 41})
    for (const std::size_t count : {1u, 2u, 1000u, kBlockPoints})
      expect_round_trip(schema, test::random_cloud(count, extent, schema.row_size(), 5));
}

TEST(Block, GivesBackPositionsAtTheEndsOfInt64) {
  test::Cloud cloud;
  const auto low = std::numeric_limits<std::int64_t>::min();
  const auto high = std::numeric_limits<std::int64_t>::max();
  cloud.positions = {{low, high, 0}, {high, low, -1}, {low, low, 1}, {0, high, high}};
  std::vector<Index3> back(4);

  const EncodedBlock block = encode_block(Schema(), cloud.positions, {});

  ASSERT_TRUE(decode_positions(column_of(block, 0), back));
  EXPECT_EQ(back, cloud.positions);
}

TEST(Block, GivesBackAMillionCopiesOfOnePointInNextToNoSpace) {
  const Schema schema = test::rich_schema();
  test::Cloud cloud;
  cloud.positions.assign(kBlockPoints, {123456789, -5, 77});
  cloud.rows.assign(kBlockPoints * schema.row_size(), std::byte{9});

  expect_round_trip(schema, cloud);

  EXPECT_LT(encode_block(schema, cloud.positions, cloud.rows).bytes.size(), 2000u);
}

TEST(Block, StoresSurfacePointsInFewerBytesThanTheirCoordinates) {
  // A flat 64 x 64 grid of 1000 steps in key order.
  test::Cloud cloud;
  for (std::int64_t i = 0; i < 4096; ++i)
    cloud.positions.push_back({i % 64 * 1000, i / 64 * 1000, 5});
  std::ranges::sort(cloud.positions,
                    [](const Index3& a, const Index3& b) { return encode_key(a) < encode_key(b); });

  const EncodedBlock block = encode_block(Schema(), cloud.positions, {});

  EXPECT_LT(block.bytes.size(), 4096u * 6);
}

TEST(Block, NeverCrashesOnPositionBytesThatAreCutOrFlipped) {
  const auto cloud = test::random_cloud(60, 1000, 0, 8);
  const EncodedBlock block = encode_block(Schema(), cloud.positions, {});
  std::vector<Index3> out(60);
  for (std::size_t size = 0; size < block.bytes.size(); ++size)
    EXPECT_FALSE(decode_positions(std::span(block.bytes).first(size), out)) << size;

  auto flipped = block.bytes;
  for (std::size_t bit = 0; bit < 8 * flipped.size(); ++bit) {
    flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    (void)decode_positions(flipped, out);
    EXPECT_NE(hash64(flipped), block.columns[0].hash) << bit;
    flipped[bit / 8] = block.bytes[bit / 8];
  }
}

}  // namespace
}  // namespace pss
