#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "io/formats/las/las_schema.h"
#include "io/points/schema.h"

namespace pss::test {
namespace {

Field field(const char* name, Type type, double scale = 1) { return {name, type, 1, scale, 0, {}}; }

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> result;
  for (const int value : values) result.push_back(static_cast<std::byte>(value));
  return result;
}

std::vector<std::byte> mapped(const Schema& from, const Schema& to,
                              const std::vector<std::byte>& rows) {
  const std::size_t count = from.row_size() == 0 ? 0 : rows.size() / from.row_size();
  std::vector<std::byte> result(count * to.row_size(), std::byte{0xEE});
  RowMapper(from, to).map(rows, result);
  return result;
}

TEST(RowMapper, IsTheIdentityForEqualSchemas) {
  const Schema schema({field("A", Type::kUint8), field("B", Type::kUint16)});

  EXPECT_TRUE(RowMapper(schema, schema).identity());
  EXPECT_EQ(mapped(schema, schema, bytes({1, 2, 3, 4, 5, 6})), bytes({1, 2, 3, 4, 5, 6}));
}

TEST(RowMapper, MatchesByNameDropsAndFillsWithZero) {
  const Schema from({field("A", Type::kUint8), field("B", Type::kUint16), field("C", Type::kInt8)});
  const Schema to({field("C", Type::kInt8), field("D", Type::kUint16), field("A", Type::kUint8)});

  EXPECT_EQ(mapped(from, to, bytes({1, 2, 3, 4, 11, 12, 13, 14})),
            bytes({4, 0, 0, 1, 14, 0, 0, 11}));
  EXPECT_EQ(RowMapper(from, to).dropped(), std::vector<std::string>{"B"});
}

TEST(RowMapper, ChangesTypesByValue) {
  const Schema from({field("A", Type::kInt8), field("B", Type::kUint16)});
  const Schema to({field("A", Type::kInt32), field("B", Type::kUint8)});

  EXPECT_EQ(mapped(from, to, bytes({0xFE, 0x2C, 0x01})),  // -2, 300
            bytes({0xFE, 0xFF, 0xFF, 0xFF, 0xFF}));       // -2, 255
  EXPECT_EQ(RowMapper(from, to).narrowed(), std::vector<std::string>{"B"});
}

TEST(RowMapper, KeepsIntegersOf64BitsExact) {
  const std::uint64_t large = 0xFFFF'FFFF'FFFF'FFFD;
  const std::int64_t least = INT64_MIN + 1;
  std::vector<std::byte> rows(16);
  std::memcpy(rows.data(), &large, 8);
  std::memcpy(rows.data() + 8, &least, 8);
  const Schema from({field("A", Type::kUint64), field("B", Type::kInt64)});
  const Schema to({field("B", Type::kInt64), field("X", Type::kUint8), field("A", Type::kUint64)});

  const std::vector<std::byte> result = mapped(from, to, rows);

  EXPECT_EQ(std::memcmp(result.data(), &least, 8), 0);
  EXPECT_EQ(std::memcmp(result.data() + 9, &large, 8), 0);
  // The same bits as another kind of integer: clamped, never wrapped.
  const auto clamped =
      mapped(from, Schema({field("A", Type::kInt64), field("B", Type::kUint64)}), rows);
  EXPECT_EQ(clamped, bytes({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F,  //
                            0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(RowMapper, ConvertsBetweenScales) {
  const Schema from({field("A", Type::kInt8)});
  const Schema to({field("A", Type::kInt16, 0.006)});

  // -90 / 0.006 = -15000 = 0xC568
  EXPECT_EQ(mapped(from, to, bytes({-90})), bytes({0x68, 0xC5}));
  EXPECT_EQ(mapped(to, from, bytes({0x68, 0xC5})), bytes({-90}));
}

TEST(RowMapper, MovesLegacyFlagsToTheirExtendedPlaces) {
  // Legacy: intensity 0x0102; return 3 of 5, scan direction 1, edge 0; class 6, synthetic and
  // withheld; angle -10; user data 7; source 0x0809.
  const auto legacy = bytes({0x02, 0x01, 0b0'1'101'011, 0b101'00110, -10, 7, 0x09, 0x08});
  // Extended: the same intensity; returns 5 and 3; flags edge 0, direction 1, channel 0, withheld
  // 1, key point 0, synthetic 1; class; user data; angle -10 / 0.006 = -1667; source; time 0.
  const auto extended = bytes({0x02, 0x01, 0b0101'0011, 0b01'00'0101, 6, 7, 0x7D, 0xF9, 0x09, 0x08,
                               0, 0, 0, 0, 0, 0, 0, 0});

  EXPECT_EQ(mapped(las_standard_schema(0), las_standard_schema(6), legacy), extended);
  EXPECT_EQ(mapped(las_standard_schema(6), las_standard_schema(0), extended), legacy);
}

TEST(RowMapper, BringsBothGenerationsOfLasToTheirUnionAndBack) {
  const auto legacy = bytes({0x02, 0x01, 0b0'1'101'011, 0b101'00110, -10, 7, 0x09, 0x08});
  const Schema from = las_standard_schema(0);
  const Schema both = unite(from, las_standard_schema(8));

  EXPECT_EQ(mapped(both, from, mapped(from, both, legacy)), legacy);
}

}  // namespace
}  // namespace pss::test
