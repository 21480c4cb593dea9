#include "io/formats/las/las_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <string>

#include "tests/io/formats/las/las_reader_fixture.h"

namespace pss::test {
namespace {

TEST_F(LasReaderTest, KeepsEveryByteAfterTheCoordinates) {
  for (int format = 0; format <= 10; ++format) {
    const LasFile file{.minor = format < 4 ? 2 : 4, .format = format, .extra = 5, .points = 4};
    const std::string bytes = las(file);
    const auto reader = open(bytes);
    ASSERT_TRUE(reader) << reader.error().message;
    const auto points = read_all(**reader, 3);
    ASSERT_TRUE(points) << points.error().message;

    ASSERT_EQ(points->index.size(), 4u);
    const std::size_t record = kRecordSizes[format] + 5;
    for (std::size_t i = 0; i < 4; ++i) {
      const char* expected = bytes.data() + get<std::uint32_t>(bytes, 96) + i * record;
      EXPECT_EQ(0,
                std::memcmp(points->rows.data() + i * (record - 12), expected + 12, record - 12));
      const auto n = static_cast<std::int64_t>(i);
      EXPECT_EQ(points->index[i], (Index3{100 * n, -100 * n, n}));
    }
  }
}

TEST_F(LasReaderTest, ReadsLas15AlsoWhereItsHeaderEndsAsThatOfLas14Does) {
  std::string short_header = las({.minor = 4, .format = 6, .points = 4});
  put(short_header, 25, std::uint8_t{5});

  for (const std::string& bytes : {las({.minor = 5, .format = 6, .points = 4}), short_header}) {
    const auto reader = open(bytes);
    ASSERT_TRUE(reader) << reader.error().message;
    const auto points = read_all(**reader);

    ASSERT_TRUE(points) << points.error().message;
    ASSERT_EQ(points->index.size(), 4u);
    EXPECT_EQ(points->index[3], (Index3{300, -300, 3}));
  }
}

TEST_F(LasReaderTest, DecodesFetchedPointsAsItReadsThem) {
  const auto reader = open(las({.minor = 4, .format = 7, .extra = 3, .points = 11}));
  ASSERT_TRUE(reader) << reader.error().message;
  const auto expected = read_all(**reader, 4);
  ASSERT_TRUE(expected) << expected.error().message;
  ASSERT_TRUE((*reader)->seek(0));

  std::array<RawPoints, 3> raw;  // fetched before any is decoded, and decoded in another order
  for (RawPoints& r : raw) ASSERT_TRUE((*reader)->fetch(4, r));
  for (const std::size_t i : {2, 0, 1}) (*reader)->decode(raw[i]);

  PointBatch all;
  for (const RawPoints& r : raw) {
    EXPECT_EQ(r.points.first_record, all.index.size());
    EXPECT_EQ(r.count, r.points.size());
    all.index.insert(all.index.end(), r.points.index.begin(), r.points.index.end());
    all.rows.insert(all.rows.end(), r.points.rows.begin(), r.points.rows.end());
  }
  EXPECT_EQ(all.index, expected->index);
  EXPECT_EQ(all.rows, expected->rows);
  ASSERT_TRUE((*reader)->fetch(4, raw[0]));
  EXPECT_EQ(raw[0].count, 0u);
}

TEST_F(LasReaderTest, SaysWhatTheHeaderSays) {
  const CloudHeader header = header_of(las({.points = 3}));

  EXPECT_EQ(header.count, 3u);
  EXPECT_EQ(header.grid, (Lattice{{0.01, 0.01, 0.01}, {0, 1000, 2000}}));
  EXPECT_EQ(header.bounds->max, (World3{2, 1000, 2000.02}));
  EXPECT_EQ(header.bounds->min, (World3{0, 998, 2000}));
  EXPECT_EQ(header.carry.head.size(), 227u);
  EXPECT_TRUE(header.warnings.empty());
}

TEST_F(LasReaderTest, ReadsTheFieldsOfBothGenerations) {
  std::string legacy = las({.format = 3, .points = 1});
  put(legacy, 227 + 12, std::uint16_t{1000});
  put(legacy, 227 + 14, std::uint8_t{0b1'0'010'001});
  put(legacy, 227 + 15, std::uint8_t{0b100'00010});
  put(legacy, 227 + 16, std::int8_t{-15});
  put(legacy, 227 + 20, 1234.5);
  put(legacy, 227 + 28, std::uint16_t{7});
  std::string extended = las({.minor = 4, .format = 8, .points = 1});
  put(extended, 375 + 14, std::uint8_t{0b1001'0111});
  put(extended, 375 + 15, std::uint8_t{0b0'1'10'1000});
  put(extended, 375 + 16, std::uint8_t{200});
  put(extended, 375 + 18, std::int16_t{-15000});
  put(extended, 375 + 36, std::uint16_t{50000});

  const auto value = [&](const std::string& content, const char* name) {
    const auto reader = open(content);
    const auto points = read_all(**reader);
    return value_at((*reader)->header().schema, *points, 0, name);
  };
  EXPECT_EQ(value(legacy, "Intensity"), 1000);
  EXPECT_EQ(value(legacy, "ReturnNumber"), 1);
  EXPECT_EQ(value(legacy, "NumberOfReturns"), 2);
  EXPECT_EQ(value(legacy, "ScanDirectionFlag"), 0);
  EXPECT_EQ(value(legacy, "EdgeOfFlightLine"), 1);
  EXPECT_EQ(value(legacy, "Classification"), 2);
  EXPECT_EQ(value(legacy, "Withheld"), 1);
  EXPECT_EQ(value(legacy, "KeyPoint"), 0);
  EXPECT_EQ(value(legacy, "ScanAngleRank"), -15);
  EXPECT_EQ(value(legacy, "GpsTime"), 1234.5);
  EXPECT_EQ(value(legacy, "Red"), 7);
  EXPECT_EQ(value(extended, "ReturnNumber"), 7);
  EXPECT_EQ(value(extended, "NumberOfReturns"), 9);
  EXPECT_EQ(value(extended, "Overlap"), 1);
  EXPECT_EQ(value(extended, "ScannerChannel"), 2);
  EXPECT_EQ(value(extended, "ScanDirectionFlag"), 1);
  EXPECT_EQ(value(extended, "EdgeOfFlightLine"), 0);
  EXPECT_EQ(value(extended, "Classification"), 200);
  EXPECT_EQ(value(extended, "ScanAngleRank"), -90);
  EXPECT_EQ(value(extended, "Infrared"), 50000);
}

TEST_F(LasReaderTest, SeeksToAnyRecord) {
  const auto reader = open(las({.points = 5}));
  PointBatch batch;

  ASSERT_TRUE((*reader)->seek(3));
  ASSERT_TRUE((*reader)->read(9, batch));

  EXPECT_EQ(batch.first_record, 3u);
  ASSERT_EQ(batch.size(), 2u);
  EXPECT_EQ(batch.index[0], (Index3{300, -300, 3}));
  EXPECT_FALSE((*reader)->seek(6));
}

TEST_F(LasReaderTest, DescribesExtraBytes) {
  const std::string descriptors = descriptor(3, "Amplitude", 8 | 16, 0.5, 10) + descriptor(9, "") +
                                  descriptor(0, "raw", 3) + descriptor(22, "pair") +
                                  descriptor(1, "Intensity");
  const LasFile file{.extra = 2 + 4 + 3 + 3 + 1 + 2,
                     .points = 1,
                     .vlrs = vlr("LASF_Spec", 4, descriptors),
                     .vlr_count = 1};
  const CloudHeader header = header_of(las(file));

  const auto& fields = header.schema.fields();
  ASSERT_EQ(fields.size(), 6u + 6u);
  EXPECT_EQ(fields[6], (Field{"Amplitude", Type::kUint16, 1, 0.5, 10, {}}));
  EXPECT_EQ(fields[7], (Field{"Extra2", Type::kFloat32, 1, 1, 0, {}}));
  EXPECT_EQ(fields[8], (Field{"raw", Type::kUint8, 3, 1, 0, {}}));
  EXPECT_EQ(fields[9], (Field{"pair", Type::kInt8, 3, 1, 0, {}}));
  EXPECT_EQ(fields[10], (Field{"Intensity_2", Type::kUint8, 1, 1, 0, {}}));
  EXPECT_EQ(fields[11], (Field{"ExtraBytes", Type::kUint8, 2, 1, 0, {}}));
}

TEST_F(LasReaderTest, IgnoresDescriptorsThatDoNotFitAndSaysSo) {
  const std::string two = descriptor(2, "fits") + descriptor(10, "does not");
  const CloudHeader header =
      header_of(las({.extra = 4, .points = 1, .vlrs = vlr("LASF_Spec", 4, two), .vlr_count = 1}));

  EXPECT_TRUE(header.schema.dimension("fits"));
  EXPECT_EQ(header.schema.dimension("ExtraBytes")->count, 3u);
  ASSERT_EQ(header.warnings.size(), 1u);
}

TEST_F(LasReaderTest, TakesSenselessScalesOfExtraBytesAsNone) {
  for (const double scale :
       {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const std::string vlrs = vlr("LASF_Spec", 4, descriptor(4, "a", 8, scale));
    const CloudHeader header =
        header_of(las({.extra = 2, .points = 1, .vlrs = vlrs, .vlr_count = 1}));
    EXPECT_EQ(header.schema.dimension("a")->scale, 1);
    EXPECT_EQ(header.warnings.size(), 1u);
  }
}

TEST_F(LasReaderTest, ReadsPointsBehindAVlrListThatReachesIntoThem) {
  const CloudHeader header =
      header_of(las({.points = 2, .vlrs = vlr("a", 1, "content"), .vlr_count = 3}));

  EXPECT_EQ(header.count, 2u);
  ASSERT_EQ(header.warnings.size(), 1u);
  EXPECT_NE(header.warnings[0].find("found 1 VLRs"), std::string::npos) << header.warnings[0];
}

TEST_F(LasReaderTest, TakesTheLegacyCountWhereTheLargeOneIsMissing) {
  std::string bytes = las({.minor = 4, .format = 1, .points = 2});
  put(bytes, 247, std::uint64_t{0});
  EXPECT_EQ(header_of(bytes).count, 2u);
}

TEST_F(LasReaderTest, SaysWhatItDoesNotCarry) {
  const LasFile file{.minor = 4,
                     .format = 6,
                     .points = 1,
                     .evlrs = evlr("copc", 1000, "abc") + evlr("mine", 7, "kept") +
                              evlr("LASF_Spec", 65535, "wave"),
                     .evlr_count = 3};
  const CloudHeader header = header_of(las(file));

  ASSERT_EQ(header.warnings.size(), 2u);
  EXPECT_NE(header.warnings[0].find("'copc' 1000"), std::string::npos);
  EXPECT_NE(header.warnings[1].find("waveform"), std::string::npos);
  const std::string kept = evlr("mine", 7, "kept");
  ASSERT_EQ(header.carry.tail.size(), kept.size());
  EXPECT_EQ(0, std::memcmp(header.carry.tail.data(), kept.data(), kept.size()));
}

TEST_F(LasReaderTest, SaysThatBytesBehindTheLastPointAreIgnored) {
  const CloudHeader header = header_of(las({.points = 1}) + "rest");

  ASSERT_EQ(header.warnings.size(), 1u);
  EXPECT_NE(header.warnings[0].find("4 bytes"), std::string::npos) << header.warnings[0];
}

TEST_F(LasReaderTest, NamesTheSystemOfGeoTiffKeys) {
  const auto keys = [](std::initializer_list<std::uint16_t> values) {
    std::string bytes;
    for (const std::uint16_t v : values)
      bytes += {static_cast<char>(v & 0xFF), static_cast<char>(v >> 8)};
    return bytes;
  };
  const auto crs = [&](const std::string& content) {
    return header_of(
               las({.points = 1, .vlrs = vlr("LASF_Projection", 34735, content), .vlr_count = 1}))
        .crs;
  };
  EXPECT_EQ(crs(keys({1, 1, 0, 2, 2048, 0, 1, 4269, 3072, 0, 1, 26910})), "EPSG:26910");
  EXPECT_EQ(crs(keys({1, 1, 0, 1, 2048, 0, 1, 4269})), "EPSG:4269");
  EXPECT_EQ(crs(keys({1, 1, 0, 2, 3072, 0, 1, 32767, 3075, 0, 1, 1})),
            "GeoTIFF:3072=32767;3075=1;");
  EXPECT_EQ(crs("odd"), "");
}

TEST(LasFiles, BothKindsOfCrsRecordNameTheSameSystem) {
  PSS_REQUIRE_DATA();
  const auto a = open_las(data_folder() / "scans/autzen_trim.las");
  const auto b = open_las(data_folder() / "scans/autzen_trim_pf7.las");

  EXPECT_EQ((*a)->header().crs, (*b)->header().crs);
  EXPECT_NE((*a)->header().crs, "");
}

}  // namespace
}  // namespace pss::test
