#include "io/formats/ply/ply_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <limits>
#include <string>

#include "io/formats/ply/ply_reader.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class PlyWriterTest : public ::testing::Test {
 protected:
  /// Writes points and gives the file's bytes, or the error's text.
  std::string write(const WriteOptions& options, const PointBatch& points) {
    const Result<void> done = try_write(options, points);
    return done ? read_text_file(path_) : done.error().message;
  }

  Result<void> try_write(const WriteOptions& options, const PointBatch& points) {
    PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_ply(path_, options));
    PSS_TRY(writer->write(points));
    PSS_TRY(writer->finish());
    notes_ = writer->notes();
    return {};
  }

  /// Reads a file, writes what was read with its carried header, reads that.
  void expect_round_trip(const std::string& input) {
    const auto reader = open_ply(input);
    ASSERT_TRUE(reader.has_value()) << reader.error().message;
    const auto points = read_all(**reader);
    ASSERT_TRUE(points.has_value()) << points.error().message;

    WriteOptions options = copy_options((*reader)->header(), points->size());
    options.rules.overwrite = true;
    const auto written = try_write(options, *points);

    ASSERT_TRUE(written.has_value()) << written.error().message;
    const auto copy = open_ply(path_);
    ASSERT_TRUE(copy.has_value()) << copy.error().message;
    const auto again = read_all(**copy);
    ASSERT_TRUE(again.has_value()) << again.error().message;
    EXPECT_TRUE(same_positions(*again, *points));
    EXPECT_EQ(again->rows, points->rows);
    EXPECT_EQ((*copy)->header().schema, (*reader)->header().schema);
    EXPECT_TRUE(notes_.empty());
  }

  static Carry carry(const std::string& head) {
    const auto bytes = std::as_bytes(std::span(head));
    return {"PLY", {bytes.begin(), bytes.end()}, {}};
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "out.ply";
  std::vector<std::string> notes_;
};

Field field(const std::string& name, Type type) { return {name, type, 1, 1, 0, {}}; }

template <class T>
void append(std::vector<std::byte>& row, T value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  row.insert(row.end(), bytes.begin(), bytes.end());
}

TEST_F(PlyWriterTest, WritesLittleEndianDoublesWhereNothingIsCarried) {
  WriteOptions options;
  options.schema = Schema({field("Intensity", Type::kUint16)});
  options.count = 1;
  PointBatch points;
  points.world = {{1.5, -2, 0.1}};
  append<std::uint16_t>(points.rows, 258);

  EXPECT_EQ(write(options, points),
            std::string("ply\nformat binary_little_endian 1.0\nelement vertex 1\n"
                        "property double x\nproperty double y\nproperty double z\n"
                        "property ushort Intensity\nend_header\n"
                        "\0\0\0\0\0\0\xf8\x3f\0\0\0\0\0\0\0\xc0\x9a\x99\x99\x99\x99\x99\xb9\x3f"
                        "\x02\x01",
                        144 + 26));
}

TEST_F(PlyWriterTest, WritesBigEndianAsTheCarriedHeaderSays) {
  WriteOptions options;
  options.schema = Schema({field("a", Type::kInt16)});
  options.count = 1;
  const std::string head =
      "ply\nformat binary_big_endian 1.0\ncomment from a scanner\nobj_info num_cols 3\n"
      "element vertex 1\nproperty int16 a\nproperty float32 z\nproperty float32 y\n"
      "property int32 x\nend_header\n";
  options.carry = carry(head);
  PointBatch points;
  points.world = {{16909060, -2, 1.5}};
  append<std::int16_t>(points.rows, -2);

  std::string expected = head;
  expected.append("\xff\xfe\x3f\xc0\0\0\xc0\0\0\0\x01\x02\x03\x04", 14);
  EXPECT_EQ(write(options, points), expected);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(PlyWriterTest, KeepsAsciiAndItsNumbers) {
  WriteOptions options;
  options.schema = Schema({field("c", Type::kFloat32), field("i", Type::kUint8)});
  options.count = 2;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty double y\n"
      "property float z\nproperty float c\nproperty uchar i\nend_header\n";
  options.carry = carry(head);
  PointBatch points;
  points.world = {{-0.0378297f, 0.1, 500000}, {1e-7f, 1.0 / 3, -0.0}};
  append(points.rows, 0.850855f);
  append<std::uint8_t>(points.rows, 255);
  append(points.rows, std::numeric_limits<float>::infinity());
  append<std::uint8_t>(points.rows, 0);

  EXPECT_EQ(write(options, points), head +
                                        "-0.0378297 0.1 500000 0.850855 255\n"
                                        "1e-07 0.3333333333333333 -0 inf 0\n");
}

TEST_F(PlyWriterTest, AppendsNewAttributesAndReplacesOldNormals) {
  WriteOptions options;
  options.schema = Schema({field("nx", Type::kFloat32), field("ny", Type::kFloat32),
                           field("nz", Type::kFloat32), field("red", Type::kUint8),
                           field("NormalX", Type::kFloat32), field("NormalY", Type::kFloat32),
                           field("NormalZ", Type::kFloat32), field("Neighbors", Type::kUint32)});
  options.count = 1;
  options.carry = carry(
      "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty double ny\nproperty float nz\n"
      "property uchar red\nelement face 2\nproperty list uchar int ids\nend_header\n");
  PointBatch points;
  points.world = {{1, 2, 3}};
  for (const float old : {9.f, 9.f, 9.f}) append(points.rows, old);
  append<std::uint8_t>(points.rows, 7);
  for (const float fresh : {0.f, 0.5f, -1.f}) append(points.rows, fresh);
  append<std::uint32_t>(points.rows, 30);

  EXPECT_EQ(write(options, points),
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            "property float z\nproperty float nx\nproperty double ny\nproperty float nz\n"
            "property uchar red\nproperty uint Neighbors\nend_header\n1 2 3 0 0.5 -1 7 30\n");
}

TEST_F(PlyWriterTest, ExpandsArraysBitFieldsAndScales) {
  Field flags{"Flags", Type::kUint8, 1, 1, 0, {{"ReturnNumber", 0, 3}, {"Edge", 3, 1}}};
  Field angle{"ScanAngle", Type::kInt16, 1, 0.006, 0, {}};
  Field pair{"Two words", Type::kInt8, 2, 1, 0, {}};
  WriteOptions options;
  options.schema = Schema({flags, angle, pair, field("Id", Type::kUint64)});
  options.count = 1;
  PointBatch points;
  points.world = {{0, 0, 0}};
  append<std::uint8_t>(points.rows, 0b1101);
  append<std::int16_t>(points.rows, -500);
  append<std::int8_t>(points.rows, -1);
  append<std::int8_t>(points.rows, 2);
  append<std::uint64_t>(points.rows, 1ull << 52);

  write(options, points);

  const auto reader = open_ply(path_);
  ASSERT_TRUE(reader.has_value()) << reader.error().message;
  const auto back = read_all(**reader);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  const Schema& schema = (*reader)->header().schema;
  EXPECT_EQ(value_at(schema, *back, 0, "ReturnNumber"), 5);
  EXPECT_EQ(value_at(schema, *back, 0, "Edge"), 1);
  EXPECT_EQ(value_at(schema, *back, 0, "ScanAngle"), 0.006 * -500);
  EXPECT_EQ(value_at(schema, *back, 0, "Two_words_0"), -1);
  EXPECT_EQ(value_at(schema, *back, 0, "Two_words_1"), 2);
  EXPECT_EQ(value_at(schema, *back, 0, "Id"), 4503599627370496.0);
  EXPECT_EQ(schema.row_size(), 1u + 1 + 8 + 1 + 1 + 8);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("'Id' is uint64"), std::string::npos) << notes_[0];
}

TEST_F(PlyWriterTest, WidensACarriedTypeThatCannotHoldTheSchema) {
  WriteOptions options;
  options.schema = Schema({field("red", Type::kUint16)});
  options.count = 1;
  options.carry = carry(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty float gone\nend_header\n");
  PointBatch points;
  points.world = {{0, 0, 0}};
  append<std::uint16_t>(points.rows, 65535);

  const std::string file = write(options, points);

  EXPECT_NE(file.find("property ushort red\nend_header\n0 0 0 65535\n"), std::string::npos) << file;
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("'gone'"), std::string::npos);
}

TEST_F(PlyWriterTest, RoundsToTheCarriedTypeAndSaysHowFar) {
  WriteOptions options;
  options.count = 1;
  options.carry = carry(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\n"
      "end_header\n");
  PointBatch points;
  points.world = {{1.25, -7.75, 3}};

  const std::string file = write(options, points);

  EXPECT_NE(file.find("end_header\n1 -8 3\n"), std::string::npos) << file;
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("0.25"), std::string::npos) << notes_[0];
}

TEST_F(PlyWriterTest, RefusesACoordinateThatTheTypeCannotHold) {
  const auto try_one = [&](const std::string& type, double x) {
    WriteOptions options;
    options.count = 1;
    options.carry = carry(
        fmt::format("ply\nformat ascii 1.0\nelement vertex 1\nproperty {} x\nproperty float y\n"
                    "property float z\nend_header\n",
                    type));
    PointBatch points;
    points.world = {{x, 0, 0}};
    return try_write(options, points);
  };

  for (const auto& [type, x] : {std::pair{"uchar", 256.0},
                                {"uchar", -1.0},
                                {"float", 1e39},
                                {"int", std::numeric_limits<double>::quiet_NaN()}}) {
    const auto written = try_one(type, x);
    ASSERT_FALSE(written.has_value()) << type << x;
    EXPECT_EQ(written.error().fault, Fault::kBadInput);
    EXPECT_FALSE(std::filesystem::exists(path_));
    EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
  }
  EXPECT_TRUE(try_one("float", std::numeric_limits<double>::infinity()).has_value());
}

TEST_F(PlyWriterTest, CorrectsTheCountWhereFewerPointsCame) {
  WriteOptions options;
  options.count = 1000;
  options.carry = carry(
      "ply\nformat ascii 1.0\ncomment element vertex 5\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n");
  PointBatch points;
  points.world = {{1, 2, 3}, {4, 5, 6}};

  const std::string file = write(options, points);

  EXPECT_NE(file.find("\nelement vertex    2\n"), std::string::npos) << file;
  const auto back = open_and_read(open_ply, path_);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_TRUE(same_positions(*back, points));
}

TEST_F(PlyWriterTest, RefusesMorePointsThanAnnounced) {
  WriteOptions options;
  options.count = 1;
  PointBatch points;
  points.world = {{1, 2, 3}, {4, 5, 6}};

  EXPECT_FALSE(try_write(options, points).has_value());
}

TEST_F(PlyWriterTest, TakesPositionsOnAGrid) {
  WriteOptions options;
  options.count = 1;
  options.grid = Lattice{{0.25, 0.5, 2}, {1000, 0, -1}};
  PointBatch points;
  points.index = {{3, -1, 4}};

  write(options, points);

  const auto back = open_and_read(open_ply, path_);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->world[0], (World3{1000.75, -0.5, 7}));
}

TEST_F(PlyWriterTest, RoundTripsRealScansWithEveryProperty) {
  PSS_REQUIRE_DATA();
  expect_round_trip((data_folder() / "scans/bunny_ascii.ply").string());
  expect_round_trip((data_folder() / "scans/pond_binary_normals_rgb.ply").string());
}

TEST_F(PlyWriterTest, CopiesABinaryFileByteForByte) {
  PSS_REQUIRE_DATA();
  const std::string input = (data_folder() / "scans/pond_binary_normals_rgb.ply").string();
  expect_round_trip(input);

  const std::string original = read_text_file(input);
  const std::string copy = read_text_file(path_);

  // What follows the vertices in the input, if anything, is no point.
  ASSERT_LE(copy.size(), original.size());
  EXPECT_TRUE(copy == original.substr(0, copy.size()));
}

}  // namespace
}  // namespace pss::test
