#include "io/las_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>

#include "io/file.h"
#include "tests/io/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class LasReaderTest : public ::testing::Test {
 protected:
  Result<std::unique_ptr<Reader>> open(const std::string& content) {
    write_text_file(path_, content);
    return open_las(path_);
  }

  CloudHeader header_of(const std::string& content) {
    auto reader = open(content);
    EXPECT_TRUE(reader) << reader.error().message;
    return reader ? (*reader)->header() : CloudHeader{};
  }

  /// Expects a refusal that names the file and every one of `parts`.
  void expect_refused(const std::string& content, std::initializer_list<const char*> parts) {
    const auto reader = open(content);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().fault, Fault::kBadInput);
    const std::string& message = reader.error().message;
    EXPECT_NE(message.find(path_), std::string::npos) << message;
    for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "test.las";
};

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

TEST_F(LasReaderTest, EveryTruncationIsRefused) {
  const LasFile file{.minor = 4,
                     .format = 6,
                     .points = 3,
                     .vlrs = vlr("someone", 1, "some content"),
                     .vlr_count = 1,
                     .evlrs = evlr("someone", 2, "more content"),
                     .evlr_count = 1};
  const std::string whole = las(file);
  ASSERT_TRUE(open(whole));

  for (std::size_t length = whole.size(); length-- > 0;) {
    std::filesystem::resize_file(path_, length);
    const auto reader = open_las(path_);
    ASSERT_FALSE(reader) << length;
    EXPECT_EQ(reader.error().fault, Fault::kBadInput) << reader.error().message;
    EXPECT_NE(reader.error().message.find(path_), std::string::npos);
  }
}

TEST_F(LasReaderTest, EveryHostileByteEndsInPointsOrARefusal) {
  const LasFile file{.minor = 4,
                     .format = 7,
                     .extra = 4,
                     .points = 2,
                     .vlrs = vlr("LASF_Spec", 4, descriptor(9, "a")) +
                             vlr("LASF_Projection", 34735, std::string(24, '\1')),
                     .vlr_count = 2,
                     .evlrs = evlr("copc", 1000, "content"),
                     .evlr_count = 1};
  const std::string whole = las(file);
  write_text_file(path_, whole);
  auto victim = File::open_or_create(path_);
  const auto bytes = std::as_bytes(std::span(whole));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const unsigned value : {0x00u, 0x7Fu, 0x80u, 0xFFu}) {
      ASSERT_TRUE(victim->write(at, std::array{static_cast<std::byte>(value)}));
      expect_bad_input_or_points(open_and_read(open_las, path_));
    }
    ASSERT_TRUE(victim->write(at, bytes.subspan(at, 1)));
  }
}

TEST_F(LasReaderTest, RefusesHostileHeadersByFieldFoundAndExpected) {
  const std::string good = las({.minor = 4, .format = 6, .points = 2});
  const auto with = [&](std::size_t offset, auto value) {
    std::string bytes = good;
    put(bytes, offset, value);
    return bytes;
  };
  expect_refused(with(0, 'X'), {"LAS header"});
  expect_refused(with(24, std::uint8_t{2}), {"offset 24", "2.4", "1.0 to 1.5"});
  expect_refused(with(25, std::uint8_t{6}), {"offset 24", "1.6"});
  expect_refused(with(94, std::uint16_t{227}), {"offset 94", "227", "375"});
  expect_refused(with(96, std::uint32_t{374}), {"offset 96", "374", "375"});
  expect_refused(with(96, 0xFFFFFFFFu), {"offset 96", "4294967295"});
  expect_refused(with(104, std::uint8_t{11}), {"offset 104", "11", "0 to 10"});
  expect_refused(with(104, std::uint8_t{0x86}), {"LAZ is not supported yet"});
  expect_refused(with(104, std::uint8_t{0x46}), {"LAZ is not supported yet"});
  expect_refused(with(105, std::uint16_t{29}), {"offset 105", "29", "at least 30"});
  expect_refused(with(105, std::uint16_t{0}), {"offset 105"});
  expect_refused(with(105, std::uint16_t{31}), {"offset 247", "found 1 points"});
  expect_refused(with(247, std::uint64_t{3}), {"offset 247", "found 2 points", "3"});
  expect_refused(with(247, ~std::uint64_t{0}), {"18446744073709551615"});
  expect_refused(with(247, std::uint64_t{1} << 63), {"offset 247"});
  for (const double scale : {0.0, -0.01, 1e-320, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()})
    expect_refused(with(139, scale), {"offset 139", "for y", "positive"});
  for (const double offset :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()})
    expect_refused(with(171, offset), {"offset 171", "for z", "finite"});
  expect_refused(with(131, 1e305), {"for x", "finite"});
}

TEST_F(LasReaderTest, RefusesEvlrsThatReachPastTheEnd) {
  const LasFile file{
      .minor = 4, .format = 6, .points = 1, .evlrs = evlr("a", 1, "content"), .evlr_count = 1};
  std::string bytes = las(file);
  const auto start = get<std::uint64_t>(bytes, 235);

  put(bytes, start + 20, std::uint64_t{8});  // one more than there is
  expect_refused(bytes, {"EVLR at offset", "expected 8 bytes"});
  put(bytes, start + 20, ~std::uint64_t{0});
  expect_refused(bytes, {"EVLR at offset"});
  put(bytes, 235, ~std::uint64_t{0});
  expect_refused(bytes, {"EVLR at offset 18446744073709551615"});
  put(bytes, 243, 0xFFFFFFFFu);
  expect_refused(bytes, {"offset 243", "4294967295"});
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

TEST_F(LasReaderTest, FileThatShrinksWhileItIsReadIsBadInput) {
  const auto reader = open(las({.points = 4}));
  std::filesystem::resize_file(path_, 227 + 3 * 20);

  const auto points = read_all(**reader);

  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().fault, Fault::kBadInput);
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

TEST(LasFiles, BrokenOnesGiveTheirPointsOrARefusal) {
  PSS_REQUIRE_DATA();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "broken")) {
    const std::string name = entry.path().filename();
    if (!name.ends_with(".las") && !name.ends_with(".laz")) continue;
    ++files;
    const auto points = open_and_read(open_las, entry.path());
    expect_bad_input_or_points(points);
    if (points) continue;
    EXPECT_NE(points.error().message.find(entry.path()), std::string::npos);
  }
  EXPECT_EQ(files, 17u);
}

/// What other readers (PDAL, laspy, las-rs) find in these files.
TEST(LasFiles, UnusualOnesAreReadWhole) {
  PSS_REQUIRE_DATA();
  const auto count = [](const char* name) -> std::size_t {
    const auto points = open_and_read(open_las, data_folder() / "broken" / name);
    EXPECT_TRUE(points) << points.error().message;
    return points ? points->size() : 0;
  };
  EXPECT_EQ(count("las-rs___history__data__d71c569a_one-point.las"), 1u);
  EXPECT_EQ(count("lasR__malformed_extrabytes.las"), 10u);
  EXPECT_EQ(count("lasR___history__8cc50130_extra_byte_deprecated.las"), 10u);
  EXPECT_EQ(count("laspy__unregistered_extra_bytes.las"), 4u);
  EXPECT_EQ(count("lazperf__cpp__test__raw-sets__no-points-1.3.las"), 0u);
  EXPECT_EQ(count("pdal__las__bad_vlr_count.las"), 10u);
  EXPECT_EQ(count("pdal__las__gps-time-nan.las"), 1u);
  EXPECT_EQ(count("pdal__las__lots_of_vlr.las"), 1u);
  EXPECT_EQ(count("pdal__las__noise-dirty.las"), 1065u);
}

TEST(LasFiles, ClippedOneIsRefusedWithBothCounts) {
  PSS_REQUIRE_DATA();
  const auto reader = open_las(data_folder() / "broken/pdal__las__1.2-with-color-clipped.las");

  ASSERT_FALSE(reader);
  EXPECT_NE(reader.error().message.find("found 1064 points"), std::string::npos);
  EXPECT_NE(reader.error().message.find("1065"), std::string::npos);
}

}  // namespace
}  // namespace pss::test
