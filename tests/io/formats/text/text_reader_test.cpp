#include "io/formats/text/text_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class TextReaderTest : public ::testing::Test {
 protected:
  PointBatch read(const std::string& content) {
    write_text_file(path_, content);
    const auto reader = open_text(path_);
    EXPECT_TRUE(reader.has_value()) << reader.error().message;
    if (!reader) return {};
    schema_ = (*reader)->header().schema;
    count_ = (*reader)->header().count;
    auto points = read_all(**reader, 2);
    EXPECT_TRUE(points.has_value()) << points.error().message;
    return points ? *std::move(points) : PointBatch{};
  }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Field& field : schema_.fields()) names.push_back(field.name);
    return names;
  }

  void expect_refused(const std::string& content, const std::string& words) {
    write_text_file(path_, content);
    const auto points = open_and_read(open_text, path_);
    ASSERT_FALSE(points.has_value()) << content.substr(0, 100);
    EXPECT_EQ(points.error().fault, Fault::kBadInput);
    EXPECT_NE(points.error().message.find(path_), std::string::npos);
    EXPECT_NE(points.error().message.find(words), std::string::npos) << points.error().message;
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "cloud.txt";
  Schema schema_;
  std::optional<std::uint64_t> count_;
};

using Names = std::vector<std::string>;

TEST_F(TextReaderTest, SplitsAtEverySeparator) {
  for (const std::string content :
       {"1 2.5 -3 4\n5 6 7 8\n", "  1\t 2.5   -3 4 \r\n5 6 7 8", "1\t2.5\t-3\t4\n5\t6\t7\t8\n",
        "1,2.5,-3,4\n5,6,7,8\n", "1, 2.5, -3, 4\n\n5 ,6 ,7 ,8\n", "1;2.5;-3;4;\n5;6;7;8;\n",
        "\xef\xbb\xbf"
        "1 2.5 -3 4\n5 6 7 8\n",
        "# a comment\n1 2.5 -3 4\n// another\n#x\n5 6 7 8\n", "1 2.5 -3 4\r5 6 7 8\r"}) {
    const PointBatch points = read(content);

    ASSERT_EQ(points.size(), 2u) << content;
    EXPECT_EQ(points.world[0], (World3{1, 2.5, -3})) << content;
    EXPECT_EQ(points.world[1], (World3{5, 6, 7})) << content;
    EXPECT_EQ(value_at(schema_, points, 0, "Intensity"), 4) << content;
    EXPECT_FALSE(count_.has_value());
  }
}

TEST_F(TextReaderTest, ReadsTheNearestDoubles) {
  const PointBatch points = read("0.1 637012.24 1e-3\n+1 nan -inf\n");

  EXPECT_EQ(points.world[0], (World3{0.1, 637012.24, 0.001}));
  EXPECT_TRUE(std::isnan(points.world[1][1]));
  EXPECT_TRUE(std::isinf(points.world[1][2]));
}

TEST_F(TextReaderTest, TakesNamesAndOrderFromAHeaderLine) {
  const PointBatch points = read("Intensity,\"Z\",Y,X,Scan angle\n9,3,2,1,-5\n");

  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points.world[0], (World3{1, 2, 3}));
  EXPECT_EQ(names(), (Names{"Intensity", "Scan angle"}));
  EXPECT_EQ(value_at(schema_, points, 0, "Intensity"), 9);
  EXPECT_EQ(value_at(schema_, points, 0, "Scan angle"), -5);
}

TEST_F(TextReaderTest, FindsTheHeaderInMostPlaces) {
  for (const std::string content :
       {"//X Y Z R G B\n1 2 3 4 5 6\n", "//X,Y,Z,R,G,B\n1,2,3,4,5,6\n",
        "# made by hand\n# x y z R G B\n# x y z\n1 2 3 4 5 6\n", "#x y z R G B\n1\t2\t3\t4\t5\t6\n",
        "x y z R G B\n1 2 3 4 5 6\n", "x;y;z;R;G;B\n1;2;3;4;5;6\n",
        "//X Y Z R G B\n1\n1 2 3 4 5 6\n", "Easting [m],Northing [m],Height (m),R,G,B\n1,2,3,4,5,6",
        "Northing,Easting,z,R,G,B\n2,1,3,4,5,6\n", "x,y,z,R,G,B\n1 2 3 4 5 6\n"}) {
    const PointBatch points = read(content);

    ASSERT_EQ(points.size(), 1u) << content;
    EXPECT_EQ(points.world[0], (World3{1, 2, 3})) << content;
    EXPECT_EQ(names(), (Names{"R", "G", "B"})) << content;
    EXPECT_EQ(value_at(schema_, points, 0, "G"), 5) << content;
  }
}

TEST_F(TextReaderTest, NamesColumnsByConventionWithoutAHeader) {
  read("1 2 3\n");
  EXPECT_EQ(names(), Names{});
  read("1 2 3 4\n");
  EXPECT_EQ(names(), Names{"Intensity"});
  read("1 2 3 4 5\n");
  EXPECT_EQ(names(), (Names{"c4", "c5"}));
  read("1 2 3 0 128 255\n");
  EXPECT_EQ(names(), (Names{"Red", "Green", "Blue"}));
  read("1 2 3 0 128 256\n");
  EXPECT_EQ(names(), (Names{"c4", "c5", "c6"}));
  read("1 2 3 0 128 255\n1 2 3 0 0.5 1\n");
  EXPECT_EQ(names(), (Names{"c4", "c5", "c6"}));
  read("1 2 3 -800 0 128 255\n");
  EXPECT_EQ(names(), (Names{"Intensity", "Red", "Green", "Blue"}));
  read("1 2 3 4 5 6 7 8\n");
  EXPECT_EQ(names(), (Names{"c4", "c5", "c6", "c7", "c8"}));
}

TEST_F(TextReaderTest, MakesNamesDistinct) {
  read("x,y,z,a,a,,a_2\n1,2,3,4,5,6,7\n");

  EXPECT_EQ(names(), (Names{"a", "a_2", "c6", "a_2_2"}));
}

TEST_F(TextReaderTest, PromisesThePointsOfACountLine) {
  const PointBatch points = read("  2\n1 2 3 4\n5 6 7 8\n\n");

  EXPECT_EQ(points.size(), 2u);
  EXPECT_EQ(count_, 2u);
  expect_refused("3\n1.0 2.0 3 4\n5 6 7 8\n", "after 2 points");
  expect_refused("1\n1 2 3 4\n5 6 7 8\n", "behind the last of 1");
  expect_refused("18446744073709551615\n1 2 3\n", "room for at most");
}

TEST_F(TextReaderTest, ReadsCloudsWithoutPoints) {
  EXPECT_EQ(read("").size(), 0u);
  EXPECT_EQ(read("\n\n# nothing\n").size(), 0u);
  EXPECT_EQ(read("0\n").size(), 0u);
  EXPECT_EQ(read("x,y,z,Intensity\n").size(), 0u);
  EXPECT_EQ(names(), Names{"Intensity"});
}

TEST_F(TextReaderTest, NamesTheLineOfWhatIsMalformed) {
  expect_refused("1 2 3 4\n5 6 7\n", "line 2 (offset 8): found 3 values, expected 4");
  expect_refused("1 2 3 4\n5 6 7 8 9\n", "found 5 values, expected 4");
  expect_refused("# c\n1 2 3 4\n\n5 6x 7 8\n", "line 4 (offset 13): found '6x' in column 'y'");
  expect_refused("1,2,3,4\n5,,7,8\n", "found '' in column 'y'");
  expect_refused("1 2 1e999\n", "range of float64");
  expect_refused("1 2\n", "at least x, y and z");
  expect_refused("x y\n1 2\n", "expected");
  expect_refused("hello world\n1 2 3\n", "'hello world'");
  expect_refused("x y z\nmore words\n1 2 3\n", "expected a point");
  expect_refused("x y z\n1 2 3 4\n", "found 4 values, expected 3");
  expect_refused(std::string(3000000, '1'), "longer than 1 MiB");
  expect_refused(std::string("\0\1\2\3", 4), "'?\?\?\?'");
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "1 ";
  expect_refused(many + "\n", "2000 columns");
}

TEST_F(TextReaderTest, SeeksToAnyPoint) {
  std::string content = "# c\n";
  for (int i = 0; i < 100; ++i) content += "0 " + std::to_string(i) + " 0\n\n# c\n";
  write_text_file(path_, content);
  const auto reader = open_text(path_);
  ASSERT_TRUE(reader.has_value()) << reader.error().message;
  PointBatch batch;

  for (const std::uint64_t record : {50u, 20u, 99u, 0u}) {
    ASSERT_TRUE((*reader)->seek(record).has_value());
    ASSERT_TRUE((*reader)->read(5, batch).has_value());

    EXPECT_EQ(batch.first_record, record);
    EXPECT_EQ(batch.size(), std::min<std::size_t>(5, 100 - record));
    EXPECT_EQ(batch.world[0][1], static_cast<double>(record));
  }
  ASSERT_TRUE((*reader)->seek(100).has_value());
  ASSERT_TRUE((*reader)->read(5, batch).has_value());
  EXPECT_EQ(batch.size(), 0u);
  EXPECT_FALSE((*reader)->seek(101).has_value());
}

TEST_F(TextReaderTest, ReadsOrRefusesEveryTruncation) {
  for (const std::string whole : {"2\r\n1 2 3 4\r\n5 6 7 8\r\n", "# x,y,z,a\n1,2,3,4\n5,6,7,8\n",
                                  "X;Y;Z;\"q\"\n1;2;3;4\n5;6;7;8\n"}) {
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      write_text_file(path_, whole.substr(0, size));

      expect_bad_input_or_points(open_and_read(open_text, path_));
    }
    EXPECT_TRUE(open_and_read(open_text, path_).has_value());
  }
}

TEST_F(TextReaderTest, RefusesEveryBrokenFileThatIsNoText) {
  PSS_REQUIRE_DATA();
  std::size_t files = 0;
  std::vector<std::string> read;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "broken")) {
    ++files;
    const auto points = open_and_read(open_text, entry.path().string());
    expect_bad_input_or_points(points);
    if (points && points->size() != 0) read.push_back(entry.path().filename().string());
  }

  // A PCD file without its header is lines of x y z.
  EXPECT_EQ(read, Names{"pdal__pcd__missingheader.pcd"});
  EXPECT_GE(files, 30u);
}

TEST_F(TextReaderTest, ReadsARealScan) {
  PSS_REQUIRE_DATA();
  const auto reader = open_text((data_folder() / "scans/ripple.pts").string());
  ASSERT_TRUE(reader.has_value()) << reader.error().message;

  const auto points = read_all(**reader);

  ASSERT_TRUE(points.has_value()) << points.error().message;
  ASSERT_EQ(points->size(), 10201u);
  EXPECT_EQ(points->world[1], (World3{-5, -4.9, -0.3605}));
  const Schema& schema = (*reader)->header().schema;
  EXPECT_EQ(value_at(schema, *points, 1, "Intensity"), 0);
  EXPECT_EQ(value_at(schema, *points, 1, "Red"), 9);
  EXPECT_EQ(value_at(schema, *points, 1, "Blue"), 55);
}

}  // namespace
}  // namespace pss::test
