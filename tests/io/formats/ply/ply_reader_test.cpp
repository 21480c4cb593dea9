#include "io/formats/ply/ply_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class PlyReaderTest : public ::testing::Test {
 protected:
  std::unique_ptr<Reader> open(const std::string& content) {
    write_text_file(path_, content);
    auto reader = open_ply(path_);
    EXPECT_TRUE(reader.has_value()) << reader.error().message;
    return reader ? *std::move(reader) : nullptr;
  }

  PointBatch read(const std::string& content) {
    const auto reader = open(content);
    if (!reader) return {};
    schema_ = reader->header().schema;
    auto points = read_all(*reader, 2);
    EXPECT_TRUE(points.has_value()) << points.error().message;
    return points ? *std::move(points) : PointBatch{};
  }

  void expect_refused(const std::string& content, const std::string& words) {
    write_text_file(path_, content);
    const auto points = open_and_read(open_ply, path_);
    ASSERT_FALSE(points.has_value()) << content;
    EXPECT_EQ(points.error().fault, Fault::kBadInput);
    EXPECT_NE(points.error().message.find(path_), std::string::npos);
    EXPECT_NE(points.error().message.find(words), std::string::npos) << points.error().message;
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "cloud.ply";
  Schema schema_;
};

std::string ascii(const std::string& count, const std::string& lines) {
  return "ply\nformat ascii 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar i\nend_header\n" +
         lines;
}

TEST_F(PlyReaderTest, ReadsBothByteOrdersFromBytesWrittenByHand) {
  const std::string body =
      "element vertex 2\nproperty short a\nproperty float z\nproperty double y\nproperty int x\n"
      "end_header\n";
  // a = 258, z = 1.5 (0x3fc00000), y = -2 (0xc000000000000000), x = 16909060 (0x01020304);
  // a = -2,  z = -0.25 (0xbe800000), y = 0.1 (0x3fb999999999999a), x = -1
  const std::string little(
      "\x02\x01\0\0\xc0\x3f\0\0\0\0\0\0\0\xc0\x04\x03\x02\x01"
      "\xfe\xff\0\0\x80\xbe\x9a\x99\x99\x99\x99\x99\xb9\x3f\xff\xff\xff\xff",
      36);
  const std::string big(
      "\x01\x02\x3f\xc0\0\0\xc0\0\0\0\0\0\0\0\x01\x02\x03\x04"
      "\xff\xfe\xbe\x80\0\0\x3f\xb9\x99\x99\x99\x99\x99\x9a\xff\xff\xff\xff",
      36);

  for (const bool is_big : {false, true}) {
    const PointBatch points =
        read(std::string("ply\nformat binary_") + (is_big ? "big" : "little") + "_endian 1.0\n" +
             body + (is_big ? big : little));

    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.world[0], (World3{16909060, -2, 1.5}));
    EXPECT_EQ(points.world[1], (World3{-1, 0.1, -0.25}));
    EXPECT_EQ(value_at(schema_, points, 0, "a"), 258);
    EXPECT_EQ(value_at(schema_, points, 1, "a"), -2);
  }
}

TEST_F(PlyReaderTest, ReadsEveryScalarTypeToItsLimits) {
  const PointBatch points = read(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty char a\nproperty uint8 b\nproperty int16 c\nproperty ushort d\n"
      "property int e\nproperty uint32 f\nproperty float g\nproperty float64 h\nend_header\n"
      "0 0 0 -128 255 -32768 65535 -2147483648 4294967295 3.4028235e38 -1.7976931348623157e308\n"
      "0.1 +0.2 3e-1 127 0 +32767 0 2147483647 12.0 1e-60 5e-324\n");

  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.world[1], (World3{0.1, 0.2, 0.3}));
  EXPECT_EQ(schema_.fields()[0].type, Type::kInt8);
  EXPECT_EQ(schema_.fields()[5].type, Type::kUint32);
  EXPECT_EQ(value_at(schema_, points, 0, "a"), -128);
  EXPECT_EQ(value_at(schema_, points, 0, "b"), 255);
  EXPECT_EQ(value_at(schema_, points, 0, "c"), -32768);
  EXPECT_EQ(value_at(schema_, points, 0, "d"), 65535);
  EXPECT_EQ(value_at(schema_, points, 0, "e"), -2147483648.0);
  EXPECT_EQ(value_at(schema_, points, 0, "f"), 4294967295.0);
  EXPECT_EQ(value_at(schema_, points, 0, "g"), std::numeric_limits<float>::max());
  EXPECT_EQ(value_at(schema_, points, 0, "h"), std::numeric_limits<double>::lowest());
  EXPECT_EQ(value_at(schema_, points, 1, "f"), 12);
  EXPECT_EQ(value_at(schema_, points, 1, "g"), 0);
  EXPECT_EQ(value_at(schema_, points, 1, "h"), std::numeric_limits<double>::denorm_min());
}

TEST_F(PlyReaderTest, PassesInfinityAndNotANumberThrough) {
  const PointBatch points = read(ascii("2", "nan -inf +inf 0\nINF Infinity -nan 1\n"));

  ASSERT_EQ(points.size(), 2u);
  EXPECT_TRUE(std::isnan(points.world[0][0]));
  EXPECT_EQ(points.world[0][1], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(points.world[1][0], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(points.world[1][2]));
}

TEST_F(PlyReaderTest, SkipsListsAndOtherElementsInAscii) {
  const auto reader = open(
      "ply\nformat ascii 1.0\nelement camera 2\nproperty float f\nproperty list uchar int ids\n"
      "element nothing 5\nelement vertex 2\nproperty float x\nproperty list uchar float ws\n"
      "property float y\nproperty float z\nelement face 1\nproperty list uchar int ids\n"
      "end_header\n0.5 2 7 8\n0.5 0\n1 3 9 9 9 2 3\n4 0 5 6\n3 0 1 1\n");
  ASSERT_TRUE(reader);

  const auto points = read_all(*reader);

  ASSERT_TRUE(points.has_value()) << points.error().message;
  ASSERT_EQ(points->size(), 2u);
  EXPECT_EQ(points->world[0], (World3{1, 2, 3}));
  EXPECT_EQ(points->world[1], (World3{4, 5, 6}));
  EXPECT_EQ(reader->header().schema.fields().size(), 0u);
  ASSERT_EQ(reader->header().warnings.size(), 4u);
  EXPECT_NE(reader->header().warnings[0].find("'ws'"), std::string::npos);
}

TEST_F(PlyReaderTest, SkipsListsAndOtherElementsInBinary) {
  const std::string data(
      "\x02\x07\x08\x01\x09"      // two cameras: lists of 2 and 1 bytes
      "\x01\x01\x05\x02\x03\x63"  // x = 1, list of one byte, y = 2, z = 3, extra = 'c'
      "\x04\0\x05\x06\x64"        // x = 4, empty list, y = 5, z = 6, extra = 'd'
      "rest",
      20);
  const auto reader = open(
      "ply\nformat binary_little_endian 1.0\nelement camera 2\nproperty list uchar uchar ids\n"
      "element vertex 2\nproperty uchar x\nproperty list uchar uchar ws\nproperty uchar y\n"
      "property uchar z\nproperty uchar extra\nend_header\n" +
      data);
  ASSERT_TRUE(reader);

  const auto points = read_all(*reader);
  ASSERT_TRUE(reader->seek(1).has_value());
  const auto second = read_all(*reader);
  ASSERT_TRUE(reader->seek(0).has_value());
  const auto again = read_all(*reader);

  ASSERT_TRUE(points.has_value()) << points.error().message;
  ASSERT_EQ(points->size(), 2u);
  EXPECT_EQ(points->world[1], (World3{4, 5, 6}));
  EXPECT_EQ(points->rows[1], std::byte{'d'});
  ASSERT_EQ(second->size(), 1u);
  EXPECT_EQ(second->world[0], (World3{4, 5, 6}));
  EXPECT_TRUE(same_positions(*again, *points));
}

TEST_F(PlyReaderTest, SeeksInEveryEncoding) {
  std::string lines;
  std::string bytes;
  for (int i = 0; i < 100; ++i) {
    lines += "0 " + std::to_string(i) + " 0 7\n\n";
    bytes += std::string(1, '\0') + static_cast<char>(i) + std::string("\0\7", 2);
  }
  const std::string binary =
      "ply\nformat binary_big_endian 1.0\nelement vertex 100\nproperty char x\nproperty char y\n"
      "property char z\nproperty uchar i\nend_header\n" +
      bytes;

  for (const std::string& content : {ascii("100", lines), binary}) {
    const auto reader = open(content);
    ASSERT_TRUE(reader);
    for (const std::uint64_t record : {50u, 20u, 99u, 0u}) {
      PointBatch batch;

      ASSERT_TRUE(reader->seek(record).has_value());
      ASSERT_TRUE(reader->read(5, batch).has_value());

      EXPECT_EQ(batch.first_record, record);
      EXPECT_EQ(batch.size(), std::min<std::size_t>(5, 100 - record));
      EXPECT_EQ(batch.world[0][1], static_cast<double>(record));
    }
    PointBatch batch;
    ASSERT_TRUE(reader->seek(100).has_value());
    ASSERT_TRUE(reader->read(5, batch).has_value());
    EXPECT_EQ(batch.size(), 0u);
    EXPECT_FALSE(reader->seek(101).has_value());
  }
}

TEST_F(PlyReaderTest, NamesTheLineOfAMalformedNumber) {
  expect_refused(ascii("2", "0 0 0 1\n0 zero 0 1\n"), "line 10");
  expect_refused(ascii("1", "0 zero 0 1\n"), "'zero' for property 'y'");
  expect_refused(ascii("1", "0.0 0.0 0.0\n"), "before property 4 of 4");
  expect_refused(ascii("1", "0 0 0 1 2\n"), "'2' behind the last");
  expect_refused(ascii("1", "0 0 0 256\n"), "range of uint8");
  expect_refused(ascii("1", "0 0 0 -1\n"), "range of uint8");
  expect_refused(ascii("1", "0 0 0 1.5\n"), "no uint8");
  expect_refused(ascii("1", "0 0 1e39 1\n"), "range of float32");
  expect_refused(ascii("1", "0 0 0x10 1\n"), "'0x10'");
  expect_refused(ascii("1", "0 0 1,5 1\n"), "'1,5'");
  expect_refused(ascii("1", "0 0 +-1 1\n"), "'+-1'");
  expect_refused(ascii("1", std::string(3 << 20, '1') + "\n"), "longer than 1 MiB");
}

TEST_F(PlyReaderTest, RefusesFewerVerticesThanPromised) {
  expect_refused(ascii("5", "0 0 0 1\n0 0 0 1\n                                            "),
                 "vertex 2 of the 5");
  expect_refused(ascii("18446744073709551615", "0 0 0 1\n"), "room for at most");
  expect_refused(
      "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty char x\n"
      "property char y\nproperty char z\nend_header\nabcdef",
      "room for at most 2");
}

TEST_F(PlyReaderTest, RefusesListsAndElementsThatCannotBeThere) {
  const std::string vertex =
      "element vertex 1\nproperty char x\nproperty char y\nproperty char z\n";
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  expect_refused(
      head + "element e 18446744073709551615\nproperty int a\n" + vertex + "end_header\nabc",
      "too early");
  expect_refused(head + "element e 1\nproperty list uint double a\n" + vertex +
                     "end_header\n\xff\xff\xff\xff" + "abc",
                 "too early");
  expect_refused(head + vertex + "property list char double a\nend_header\nabc\xff",
                 "list of length -1");
  expect_refused("ply\nformat ascii 1.0\nelement e 18446744073709551615\nproperty int a\n" +
                     vertex + "end_header\n1\n1\n1 2 3\n",
                 "after 3 entries");
}

TEST_F(PlyReaderTest, RefusesFilesWithoutPositions) {
  expect_refused("ply\nformat ascii 1.0\nend_header\n", "'vertex'");
  expect_refused("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", "'x'");
  expect_refused(
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
      "property list uchar float z\nend_header\n",
      "'z'");
}

TEST_F(PlyReaderTest, ReadsAnEmptyCloud) { EXPECT_EQ(read(ascii("0", "")).size(), 0u); }

TEST_F(PlyReaderTest, ReadsOrRefusesEveryTruncation) {
  const std::string text = ascii("3", "1 2 3 4\r\n5 6 7 8\r\n9 10 11 12\r\n");
  const std::string bytes =
      "ply\r\nformat binary_big_endian 1.0\r\nelement vertex 3\r\nproperty char x\r\n"
      "property char y\r\nproperty char z\r\nproperty short a\r\nend_header\r\nabcdefghijklmno";
  const std::string lists =
      "ply\nformat binary_little_endian 1.0\nelement e 1\nproperty list uchar char q\n"
      "element vertex 2\nproperty char x\nproperty list uchar short w\nproperty char y\n"
      "property char z\nend_header\n\2qqx\1wwyzx\2wwwwyz";
  for (const std::string& whole : {text, bytes, lists}) {
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      write_text_file(path_, whole.substr(0, size));

      const auto points = open_and_read(open_ply, path_);

      // Only the end of the last line may be missing, or digits of the last number.
      EXPECT_TRUE(size + 4 >= whole.size() || !points.has_value()) << size;
      EXPECT_TRUE(size < whole.size() || points.has_value()) << points.error().message;
      expect_bad_input_or_points(points);
    }
  }
}

TEST_F(PlyReaderTest, ReadsOrRefusesEveryBrokenFile) {
  PSS_REQUIRE_DATA();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "broken")) {
    if (entry.path().extension() != ".ply") continue;
    ++files;

    const auto points = open_and_read(open_ply, entry.path().string());

    expect_bad_input_or_points(points);
  }
  EXPECT_EQ(files, 10u);
}

TEST_F(PlyReaderTest, ReadsTheOddFilesOfOtherProjects) {
  PSS_REQUIRE_DATA();
  const std::filesystem::path broken = data_folder() / "broken";
  const auto count = [&](const char* name) -> std::size_t {
    const auto points = open_and_read(open_ply, (broken / name).string());
    EXPECT_TRUE(points.has_value()) << points.error().message;
    return points ? points->size() : 0;
  };

  EXPECT_EQ(count("debian-assimp__test__models__PLY__cube_binary_header_with_RN_newline.ply"), 8u);
  EXPECT_EQ(count("debian-draco__testdata__float_inf_point_cloud.ply"), 16u);
  EXPECT_EQ(count("debian-draco__testdata__test_extra_whitespace.ply"), 3u);
  EXPECT_EQ(count("debian-trimesh__models__points_emptyface.ply"), 1024u);
  EXPECT_EQ(count("pdal__ply__issue_2421.ply"), 1u);
  EXPECT_EQ(count("pdal__ply__text_extradim.ply"), 1u);
}

}  // namespace
}  // namespace pss::test
