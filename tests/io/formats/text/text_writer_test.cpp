#include "io/formats/text/text_writer.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "io/formats/text/text_layout.h"
#include "io/formats/text/text_reader.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class TextWriterTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const WriteOptions& options,
                    const PointBatch& points) {
    const std::string path = directory_ / name;
    const Result<void> done = try_write(path, options, points);
    EXPECT_TRUE(done.has_value()) << done.error().message;
    return read_text_file(path);
  }

  Result<void> try_write(const std::string& path, const WriteOptions& options,
                         const PointBatch& points) {
    PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_text(path, options));
    PSS_TRY(writer->write(points));
    PSS_TRY(writer->finish());
    notes_ = writer->notes();
    return {};
  }

  /// Reads a file of this content and name and writes it under another name.
  std::string convert(const std::string& from, const std::string& content, const std::string& to,
                      const std::vector<Field>& added = {}) {
    write_text_file(directory_ / from, content);
    return convert_file(directory_ / from, to, added);
  }

  std::string convert_file(const std::string& path, const std::string& to,
                           const std::vector<Field>& added = {}) {
    const auto reader = open_text(path);
    EXPECT_TRUE(reader.has_value()) << reader.error().message;
    auto points = read_all(**reader);
    EXPECT_TRUE(points.has_value()) << points.error().message;
    WriteOptions options = copy_options((*reader)->header(), points->size());
    for (const Field& field : added) options.schema.add(field);
    PointBatch wide = *points;
    wide.rows.resize(points->size() * options.schema.row_size());
    RowMapper((*reader)->header().schema, options.schema).map(points->rows, wide.rows);
    return write(to, options, wide);
  }

  TemporaryDirectory directory_;
  std::vector<std::string> notes_;
};

Field field(const std::string& name, Type type) { return {name, type, 1, 1, 0, {}}; }

/// One point with an intensity and a colour.
PointBatch coloured_point(WriteOptions& options) {
  options.schema =
      Schema({field("Red", Type::kUint8), field("Green", Type::kUint8), field("Blue", Type::kUint8),
              field("Scan Angle", Type::kFloat32), field("Intensity", Type::kUint16)});
  options.count = 1;
  PointBatch points;
  points.world = {{0.1, 500000, -3}};
  points.rows.resize(options.schema.row_size());
  const char* names[] = {"Red", "Green", "Blue", "Scan Angle", "Intensity"};
  const double values[] = {1, 2, 255, 0.1f, 65535};
  for (std::size_t i = 0; i < 5; ++i)
    write_value(*options.schema.dimension(names[i]), points.rows.data(), values[i]);
  return points;
}

TEST_F(TextWriterTest, FollowsTheExtensionWhereNothingIsCarried) {
  WriteOptions options;
  const PointBatch points = coloured_point(options);

  EXPECT_EQ(write("a.csv", options, points),
            "x,y,z,Red,Green,Blue,Scan Angle,Intensity\n0.1,500000,-3,1,2,255,0.1,65535\n");
  EXPECT_EQ(write("a.txt", options, points),
            "x y z Red Green Blue Scan_Angle Intensity\n0.1 500000 -3 1 2 255 0.1 65535\n");
  EXPECT_EQ(notes_, std::vector<std::string>{});
  EXPECT_EQ(write("a.xyz", options, points), "0.1 500000 -3 1 2 255 0.1 65535\n");
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_EQ(notes_[0], "the columns are x y z Red Green Blue Scan_Angle Intensity");
  EXPECT_EQ(write("a.pts", options, points), "1\n0.1 500000 -3 65535 1 2 255 0.1\n");
}

TEST_F(TextWriterTest, KeepsTheLayoutOfTheFileThePointsCameFrom) {
  for (const std::string content :
       {"# made by hand\n// X,Y,Z,a\n1,2,3,4\n5,6,7,8.5\n", "a;Z;Y;X\n1;2;3;4\n", "1 2 3\n4 5 6\n",
        "//X Y Z i\n2\n1 2 3 4\n5 6 7 8\n", "2\n1\t2\t3\t4\n5\t6\t7\t8\n", "1 2 3 4 5\n"}) {
    EXPECT_EQ(convert("in.txt", content, "out.TXT"), content);
    EXPECT_TRUE(notes_.empty());
    std::filesystem::remove(directory_ / "out.TXT");
  }
}

TEST_F(TextWriterTest, TakesTheLayoutOfAnotherExtension) {
  EXPECT_EQ(convert("in.xyz", "# c\n1 2 3 4\n", "a.csv"), "x,y,z,Intensity\n1,2,3,4\n");
  EXPECT_EQ(convert("in.csv", "b,z,y,x\n1,2,3,4\n", "b.txt"), "b z y x\n1 2 3 4\n");
  EXPECT_EQ(convert("in.csv", "b,z,y,x\n1,2,3,4\n", "c.xyz"), "b z y x\n1 2 3 4\n");
  EXPECT_EQ(convert("in.xyz", "1 2 3 4\n", "d.pts"), "1\n1 2 3 4\n");
}

TEST_F(TextWriterTest, AppendsNewColumns) {
  const std::vector<Field> added{field("NormalX", Type::kFloat32), field("Status", Type::kUint8)};

  EXPECT_EQ(convert("in.csv", "X,Y,Z,a\n1,2,3,4\n", "a.csv", added),
            "X,Y,Z,a,NormalX,Status\n1,2,3,4,0,0\n");
  EXPECT_TRUE(notes_.empty());
  EXPECT_EQ(convert("in.xyz", "1 2 3 4\n", "a.xyz", added), "1 2 3 4 0 0\n");
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_EQ(notes_[0], "the columns are x y z Intensity NormalX Status");
}

TEST_F(TextWriterTest, DropsColumnsThatTheSchemaLacks) {
  write_text_file(directory_ / "in.csv", "a,x,b,y,z\n9,1,8,2,3\n");
  const auto reader = open_text(directory_ / "in.csv");
  ASSERT_TRUE(reader.has_value()) << reader.error().message;
  WriteOptions options = copy_options((*reader)->header(), 1);
  options.schema = Schema();
  PointBatch points;
  points.world = {{1, 2, 3}};

  EXPECT_EQ(write("out.csv", options, points), "x,y,z\n1,2,3\n");
  EXPECT_EQ(notes_, (std::vector<std::string>{"column 'a' is dropped", "column 'b' is dropped"}));
}

TEST_F(TextWriterTest, WritesGridPositionsAsDecimals) {
  WriteOptions options;
  options.count = 2;
  options.grid = Lattice{{0.01, 0.001, 0.25}, {637000.25, -0.1, 0}};
  PointBatch points;
  points.index = {{1199, 3, -1}, {-63700025, 100, 8}};

  EXPECT_EQ(write("a.xyz", options, points), "637012.24 -0.097 -0.25\n0 0 2\n");
}

TEST_F(TextWriterTest, WritesTheShortestNumberWithinWhatIsKnownOfAPosition) {
  WriteOptions options{.count = 1};
  options.grid = Lattice{{0x1p-24, 0x1p-24, 0x1p-24}, {0, 0, 0}};
  options.tolerance = 0x1p-25;
  PointBatch points;
  points.index.push_back(to_index(*options.grid, {0.1, -123456.789, 1 + 0x1p-23}));

  // The last is two steps from 1, which is too far to be taken for it.
  EXPECT_EQ(write("a.xyz", options, points), "0.1 -123456.789 1.0000001\n");
}

TEST_F(TextWriterTest, WritesScalesBitsAndLargeIntegersAsTheyAre) {
  Field flags{"Flags", Type::kUint8, 1, 1, 0, {{"ReturnNumber", 0, 3}, {"Edge", 3, 1}}};
  Field angle{"ScanAngle", Type::kInt16, 1, 0.006, 0, {}};
  WriteOptions options;
  options.schema = Schema({flags, angle, field("Id", Type::kUint64)});
  options.count = 1;
  PointBatch points;
  points.world = {{0, 0, 0}};
  points.rows.resize(options.schema.row_size(), std::byte{0xff});
  write_value(*options.schema.dimension("ScanAngle"), points.rows.data(), 0.018);

  EXPECT_EQ(write("a.csv", options, points),
            "x,y,z,ReturnNumber,Edge,ScanAngle,Id\n0,0,0,7,1,0.018,18446744073709551615\n");
}

TEST_F(TextWriterTest, CorrectsTheCountWhereFewerPointsCame) {
  WriteOptions options;
  options.count = 1000;
  PointBatch points;
  points.world = {{1, 2, 3}, {4, 5, 6}};

  EXPECT_EQ(write("a.pts", options, points), "   2\n1 2 3\n4 5 6\n");
  const auto back = open_and_read(open_text, directory_ / "a.pts");
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_TRUE(same_positions(*back, points));
}

TEST_F(TextWriterTest, RefusesMorePointsThanAnnounced) {
  WriteOptions options;
  options.count = 1;
  PointBatch points;
  points.world = {{1, 2, 3}, {4, 5, 6}};

  EXPECT_FALSE(try_write(directory_ / "a.xyz", options, points).has_value());
  EXPECT_FALSE(std::filesystem::exists(directory_ / "a.xyz"));
}

TEST_F(TextWriterTest, RefusesADamagedLayout) {
  WriteOptions options;
  options.carry = Carry{"text", {std::byte{'x'}}, {}};

  const auto written = try_write(directory_ / "a.xyz", options, {});

  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().fault, Fault::kBadInput);
}

TEST_F(TextWriterTest, RoundTripsARealScan) {
  PSS_REQUIRE_DATA();
  const std::string input = (data_folder() / "scans/ripple.pts").string();
  convert_file(input, "copy.pts");

  const auto original = open_and_read(open_text, input);
  const auto copy = open_and_read(open_text, directory_ / "copy.pts");

  ASSERT_TRUE(copy.has_value()) << copy.error().message;
  EXPECT_EQ(copy->size(), 10201u);
  EXPECT_TRUE(same_positions(*copy, *original));
  EXPECT_EQ(copy->rows, original->rows);
}

TEST_F(TextWriterTest, UnpacksTheLayoutItPacked) {
  const TextLayout layout{.extension = "csv",
                          .separator = '\t',
                          .comments = {"# one", "//  two "},
                          .header = "// ",
                          .counted = true,
                          .columns = {"a b", "x", "z", "y"},
                          .axes = {1, 3, 2}};

  const auto back = unpack_text_layout(pack(layout));

  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(*back, layout);
}

}  // namespace
}  // namespace pss::test
