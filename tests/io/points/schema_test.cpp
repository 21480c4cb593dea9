#include "io/points/schema.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "io/formats/las/las_schema.h"

namespace pss::test {
namespace {

Field field(const char* name, Type type, std::uint32_t count = 1, double scale = 1,
            double offset = 0) {
  return {name, type, count, scale, offset, {}};
}

Field container(const char* name, Type type, std::vector<BitField> bits) {
  return {name, type, 1, 1, 0, std::move(bits)};
}

/// A row of one field, and its dimension.
struct Cell {
  explicit Cell(Field f) : dimension(*Schema({f}).dimension(f.name)) {}
  double round_trip(double value) {
    write_value(dimension, bytes.data(), value);
    return read_value(dimension, bytes.data());
  }
  Dimension dimension;
  std::array<std::byte, 64> bytes{};
};

TEST(Schema, PlacesFieldsOneBehindTheOther) {
  const Schema schema(
      {field("A", Type::kUint8), field("B", Type::kFloat64, 3), field("C", Type::kInt16)});

  EXPECT_EQ(schema.row_size(), 1u + 24u + 2u);
  EXPECT_EQ(schema.position(1), 1u);
  EXPECT_EQ(schema.position(2), 25u);
  EXPECT_EQ(schema.find("B"), 1u);
  EXPECT_FALSE(schema.find("D"));
}

TEST(Schema, NamesBitFieldsAndNotTheirContainer) {
  const Schema schema({field("A", Type::kUint8),
                       container("Flags", Type::kUint8, {{"Low", 0, 3}, {"High", 3, 5}})});

  ASSERT_EQ(schema.dimensions().size(), 3u);
  EXPECT_EQ(schema.dimension("High")->position, 1u);
  EXPECT_EQ(schema.dimension("High")->shift, 3);
  EXPECT_FALSE(schema.dimension("Flags"));
}

TEST(Values, ReadBitFieldsFromTheirBits) {
  const Schema schema({container("F", Type::kUint8, {{"Low", 0, 3}, {"High", 3, 5}})});
  const std::byte row{0b10110'101};

  EXPECT_EQ(read_value(*schema.dimension("Low"), &row), 5);
  EXPECT_EQ(read_value(*schema.dimension("High"), &row), 22);
}

TEST(Values, WriteBitFieldsWithoutTouchingTheirNeighbours) {
  const Schema schema({container("F", Type::kUint8, {{"Low", 0, 3}, {"High", 3, 5}})});
  std::byte row{0b10110'101};

  write_value(*schema.dimension("Low"), &row, 2);
  EXPECT_EQ(row, std::byte{0b10110'010});
  write_value(*schema.dimension("High"), &row, 99);  // at most 31
  EXPECT_EQ(row, std::byte{0b11111'010});
}

TEST(Values, AreRoundedAndClampedToWhatFits) {
  EXPECT_EQ(Cell(field("A", Type::kUint8)).round_trip(-3), 0);
  EXPECT_EQ(Cell(field("A", Type::kUint8)).round_trip(255.4), 255);
  EXPECT_EQ(Cell(field("A", Type::kUint8)).round_trip(1e300), 255);
  EXPECT_EQ(Cell(field("A", Type::kInt8)).round_trip(-129), -128);
  EXPECT_EQ(Cell(field("A", Type::kInt16)).round_trip(-1.6), -2);
  EXPECT_EQ(Cell(field("A", Type::kInt32)).round_trip(-1e10), -2147483648.0);
  EXPECT_EQ(Cell(field("A", Type::kUint64)).round_trip(1e30), 18446744073709551615.0);
  EXPECT_EQ(Cell(field("A", Type::kInt64)).round_trip(-1e30), -9223372036854775808.0);
  EXPECT_EQ(Cell(field("A", Type::kInt64)).round_trip(-INFINITY), -9223372036854775808.0);
  EXPECT_EQ(Cell(field("A", Type::kUint32)).round_trip(NAN), 0);
  EXPECT_EQ(Cell(field("A", Type::kFloat32)).round_trip(1e300), std::numeric_limits<float>::max());
  EXPECT_TRUE(std::isnan(Cell(field("A", Type::kFloat32)).round_trip(NAN)));
  EXPECT_EQ(Cell(field("A", Type::kFloat64)).round_trip(1e300), 1e300);
}

TEST(Values, ApplyScaleAndOffset) {
  Cell cell(field("A", Type::kInt16, 1, 0.5, 100));

  EXPECT_EQ(cell.round_trip(103.2), 103);
  EXPECT_EQ(cell.bytes[0], std::byte{6});
}

TEST(Values, HaveElements) {
  Cell cell(field("A", Type::kUint16, 3));
  write_value(cell.dimension, cell.bytes.data(), 513, 2);

  EXPECT_EQ(cell.bytes[4], std::byte{1});
  EXPECT_EQ(cell.bytes[5], std::byte{2});
  EXPECT_EQ(read_value(cell.dimension, cell.bytes.data(), 1), 0);
}

TEST(Unite, KeepsTheFirstAndAppendsWhatOnlyTheSecondHas) {
  const Schema a({field("A", Type::kUint8), field("B", Type::kInt32)});
  const Schema b({field("C", Type::kFloat32), field("A", Type::kUint8)});

  EXPECT_EQ(unite(a, b), Schema({field("A", Type::kUint8), field("B", Type::kInt32),
                                 field("C", Type::kFloat32)}));
  EXPECT_EQ(unite(a, a), a);
  EXPECT_EQ(unite(a, Schema()), a);
  EXPECT_EQ(unite(Schema(), b), b);
}

TEST(Unite, TakesATypeThatHoldsBoth) {
  struct Case {
    Type a, b, both;
  };
  for (const Case& c : {Case{Type::kUint8, Type::kUint16, Type::kUint16},
                        Case{Type::kUint8, Type::kInt8, Type::kInt16},
                        Case{Type::kInt32, Type::kUint32, Type::kInt64},
                        Case{Type::kUint64, Type::kInt8, Type::kFloat64},
                        Case{Type::kInt16, Type::kFloat32, Type::kFloat32},
                        Case{Type::kInt32, Type::kFloat32, Type::kFloat64},
                        Case{Type::kFloat32, Type::kFloat64, Type::kFloat64}}) {
    const Schema expected({field("A", c.both)});
    EXPECT_EQ(unite(Schema({field("A", c.a)}), Schema({field("A", c.b)})), expected);
    EXPECT_EQ(unite(Schema({field("A", c.b)}), Schema({field("A", c.a)})), expected);
  }
}

TEST(Unite, TakesTheFinerScaleWhereItReachesAsFar) {
  const Field legacy = field("ScanAngleRank", Type::kInt8);
  const Field extended = field("ScanAngleRank", Type::kInt16, 1, 0.006);

  EXPECT_EQ(unite(Schema({legacy}), Schema({extended})), Schema({extended}));
  EXPECT_EQ(unite(Schema({extended}), Schema({legacy})), Schema({extended}));
  // 16 bits of 0.0001 reach 3.3 only.
  EXPECT_EQ(unite(Schema({legacy}), Schema({field("ScanAngleRank", Type::kInt16, 1, 1e-4)})),
            Schema({field("ScanAngleRank", Type::kFloat64)}));
}

TEST(Unite, OfEveryPairOfPointFormatsHoldsEveryDimensionOnceAndWide) {
  for (std::uint8_t p = 0; p <= kLasLastFormat; ++p)
    for (std::uint8_t q = 0; q <= kLasLastFormat; ++q) {
      const Schema a = las_standard_schema(p);
      const Schema b = las_standard_schema(q);
      const Schema both = unite(a, b);
      for (const Schema& part : {a, b}) {
        const RowMapper mapper(part, both);
        EXPECT_TRUE(mapper.dropped().empty()) << int{p} << " " << int{q};
        for (const std::string& name : mapper.narrowed()) EXPECT_EQ(name, "ScanAngleRank");
      }
      for (const Dimension& d : both.dimensions()) {
        std::size_t same = 0;
        for (const Dimension& other : both.dimensions()) same += d.name == other.name;
        EXPECT_EQ(same, 1u) << d.name << " " << int{p} << " " << int{q};
      }
    }
}

TEST(Unite, GivesReturnsAndClassesTheExtendedWidth) {
  const Schema both = unite(las_standard_schema(1), las_standard_schema(6));

  EXPECT_EQ(both.dimension("ReturnNumber")->width, 4);
  EXPECT_EQ(both.dimension("Classification")->width, 0);
  EXPECT_EQ(both.dimension("Classification")->type, Type::kUint8);
  EXPECT_EQ(both.dimension("Withheld")->width, 1);
  EXPECT_TRUE(both.dimension("ScannerChannel"));
}

}  // namespace
}  // namespace pss::test
