#include "io/convert.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/open.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class ConvertTest : public ::testing::Test {
 protected:
  std::string input(const std::string& name, const std::string& content) {
    write_text_file(directory_ / name, content);
    return directory_ / name;
  }

  Result<ConvertSummary> run(const std::vector<std::string>& inputs, const std::string& output,
                             const ConvertOptions& options = {}) {
    Monitor monitor;
    return convert(inputs, directory_ / output, options, monitor);
  }

  /// Converts and gives the header and points of what was written.
  ConvertSummary expect_converted(const std::vector<std::string>& inputs, const std::string& output,
                                  const ConvertOptions& options = {}) {
    auto summary = run(inputs, output, options);
    EXPECT_TRUE(summary) << summary.error().message;
    auto reader = open_reader(directory_ / output);
    EXPECT_TRUE(reader) << reader.error().message;
    if (!summary || !reader) return {};
    header_ = (*reader)->header();
    auto points = read_all(**reader);
    EXPECT_TRUE(points) << points.error().message;
    if (points) points_ = *std::move(points);
    return *summary;
  }

  void expect_nothing_at(const std::string& output) const {
    EXPECT_FALSE(std::filesystem::exists(directory_ / output));
    EXPECT_FALSE(std::filesystem::exists(directory_ / (output + ".part")));
  }

  World3 world(std::size_t i) const {
    return header_.grid ? to_world(*header_.grid, points_.index[i]) : points_.world[i];
  }

  TemporaryDirectory directory_;
  CloudHeader header_;
  PointBatch points_;
};

/// Every whole LAS file of a folder of the test data.
std::vector<std::filesystem::path> las_files(const char* folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / folder))
    if (entry.path().extension() == ".las") files.push_back(entry.path());
  return files;
}

TEST_F(ConvertTest, LasToLasIsTheIdentityOnTheWholeFile) {
  PSS_REQUIRE_DATA();
  std::size_t files = 0;
  for (const char* folder : {"scans", "pairs"})
    for (const auto& path : las_files(folder)) {
      const auto summary = run({path}, "out.las", {.overwrite = true});
      ASSERT_TRUE(summary) << summary.error().message;
      EXPECT_TRUE(read_text_file(path) == read_text_file(directory_ / "out.las")) << path;
      EXPECT_EQ(summary->points_in, summary->points_out);
      ++files;
    }
  EXPECT_EQ(files, 19u);
}

TEST_F(ConvertTest, UnusualLasFilesArePassedOnAsTheyAre) {
  PSS_REQUIRE_DATA();
  for (const auto& path : las_files("broken")) {
    const auto summary = run({path}, "out.las", {.overwrite = true});
    if (!summary) {
      EXPECT_EQ(summary.error().fault, Fault::kBadInput);
      EXPECT_NE(summary.error().message.find(path), std::string::npos);
      continue;
    }
    EXPECT_TRUE(read_text_file(path) == read_text_file(directory_ / "out.las")) << path;
  }
}

TEST_F(ConvertTest, EveryTruncationLeavesNothingUnderTheOutputsName) {
  const std::string whole = las({.format = 1, .points = 2});
  const std::string path = input("in.las", whole);
  for (std::size_t length = whole.size(); length-- > 0;) {
    std::filesystem::resize_file(path, length);
    const auto summary = run({path}, "out.las");
    ASSERT_FALSE(summary);
    EXPECT_EQ(summary.error().fault, Fault::kBadInput);
    expect_nothing_at("out.las");
  }
}

TEST_F(ConvertTest, SeveralInputsFollowEachOtherWithTheUnionOfTheirAttributes) {
  const std::string a = input("a.las", las({.format = 0, .points = 3}));
  const std::string b = input("b.las", las({.minor = 4, .format = 7, .points = 2}));

  const ConvertSummary summary = expect_converted({a, b}, "out.las");

  EXPECT_EQ(summary.points_in, 5u);
  EXPECT_EQ(summary.points_out, 5u);
  ASSERT_EQ(points_.size(), 5u);
  EXPECT_EQ(points_.index[3], (Index3{0, 0, 0}));
  EXPECT_EQ(points_.index[4], (Index3{100, -100, 1}));
  for (const char* name : {"Red", "GpsTime", "Overlap", "ScannerChannel"})
    EXPECT_TRUE(header_.schema.dimension(name)) << name;
  // Bytes of the second point of each file count up from 16.
  EXPECT_EQ(value_at(header_.schema, points_, 1, "Intensity"), 28 + 256 * 29);
  EXPECT_EQ(value_at(header_.schema, points_, 4, "Intensity"), 28 + 256 * 29);
  EXPECT_EQ(value_at(header_.schema, points_, 4, "Classification"), 32);
  EXPECT_EQ(value_at(header_.schema, points_, 1, "Red"), 0);
}

TEST_F(ConvertTest, OtherGridsAreRoundedToTheFirst) {
  std::string other = las({.points = 2});
  for (std::size_t a = 0; a < 3; ++a) put(other, 131 + 8 * a, 0.001);
  const std::string a = input("a.las", las({.points = 2}));
  const std::string b = input("b.las", other);

  expect_converted({a, b}, "out.las");

  EXPECT_EQ(header_.grid->scale[0], 0.01);
  EXPECT_EQ(points_.index[3], (Index3{10, -10, 0}));
}

TEST_F(ConvertTest, ChoosesAGridWhereTheFirstDoesNotReach) {
  std::string fine = las({.points = 2});
  std::string far = las({.points = 2});
  for (std::size_t a = 0; a < 3; ++a) put(fine, 131 + 8 * a, 1e-6);
  put(far, 155, 1e6);
  put(far, 179, 1e6 + 1);
  put(far, 187, 1e6);

  const ConvertSummary summary =
      expect_converted({input("a.las", fine), input("b.las", far)}, "out.las");

  EXPECT_NEAR(world(3)[0], 1e6 + 1, 0.001);
  EXPECT_FALSE(summary.notes.empty());
}

TEST_F(ConvertTest, TextToLasKeepsOrderAndColumns) {
  const std::string text = input("a.csv", "X,Y,Z,Quality\n1.5,2.25,-3,0.5\n-1,1000000,3,0.25\n");

  const ConvertSummary summary = expect_converted({text}, "out.las");

  EXPECT_EQ(summary.points_out, 2u);
  ASSERT_EQ(points_.size(), 2u);
  EXPECT_NEAR(world(0)[1], 2.25, 0.001);
  EXPECT_NEAR(world(1)[0], -1, 1e-8);
  EXPECT_EQ(value_at(header_.schema, points_, 1, "Quality"), 0.25);
}

TEST_F(ConvertTest, LasToPlyAndBackKeepsPositionsAndAttributes) {
  const std::string a = input("a.las", las({.format = 3, .points = 4}));
  expect_converted({a}, "b.ply");
  ASSERT_EQ(points_.size(), 4u);
  expect_converted({directory_ / "b.ply"}, "c.las", {.scale = World3{0.01, 0.01, 0.01}});

  const auto reader = open_reader(a);
  const auto original = read_all(**reader);
  const CloudHeader& before = (*reader)->header();
  for (std::size_t i = 0; i < 4; ++i) {
    const World3 p = to_world(*before.grid, original->index[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(world(i)[axis], p[axis], 0.00501);
    for (const Dimension& d : before.schema.dimensions()) {
      const double tolerance = d.name == "ScanAngleRank" ? 0.003 : 0;
      EXPECT_NEAR(value_at(header_.schema, points_, i, d.name),
                  value_at(before.schema, *original, i, d.name), tolerance)
          << d.name;
    }
  }
}

constexpr const char* kPlyWithNan =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property double z\nproperty uchar q\nend_header\n0 0 0 1\nnan 0 0 2\n1 1 1 3\n0 inf 0 4\n";

TEST_F(ConvertTest, DropsAndCountsPositionsThatLasCannotHold) {
  const ConvertSummary summary = expect_converted({input("a.ply", kPlyWithNan)}, "out.las");

  EXPECT_EQ(summary.points_in, 4u);
  EXPECT_EQ(summary.points_out, 2u);
  ASSERT_EQ(summary.dropped.size(), 1u);
  EXPECT_EQ(summary.dropped.begin()->second, 2u);
  EXPECT_EQ(header_.count, 2u);
  EXPECT_EQ(value_at(header_.schema, points_, 1, "q"), 3);
}

TEST_F(ConvertTest, KeepsPositionsThatPlyCanHold) {
  const ConvertSummary summary = expect_converted({input("a.ply", kPlyWithNan)}, "out.ply");

  EXPECT_EQ(summary.points_out, 4u);
  EXPECT_TRUE(summary.dropped.empty());
}

TEST_F(ConvertTest, RefusesCoordinateSystemsThatDiffer) {
  const auto with_code = [](std::uint16_t code) {
    std::string keys(16, '\0');
    put(keys, 8, std::uint16_t{3072});
    put(keys, 12, std::uint16_t{1});
    put(keys, 14, code);
    return las({.points = 1, .vlrs = vlr("LASF_Projection", 34735, keys), .vlr_count = 1});
  };
  const std::string a = input("a.las", with_code(2994));
  const std::string b = input("b.las", with_code(26910));
  const std::string none = input("none.las", las({.points = 1}));

  const auto summary = run({a, none, b}, "out.las");

  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().fault, Fault::kBadInput);
  for (const char* part : {"a.las", "b.las", "EPSG:2994", "EPSG:26910"})
    EXPECT_NE(summary.error().message.find(part), std::string::npos) << summary.error().message;
  expect_nothing_at("out.las");
  EXPECT_TRUE(run({a, none}, "out.las"));
}

TEST_F(ConvertTest, FailureInTheMiddleLeavesTheOldFile) {
  const std::string a = input("a.las", las({.points = 2}));
  const std::string b =
      input("b.ply",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
            "property float y\nproperty float z\nend_header\n0 0 0\n0 rubbish 0\n");
  const std::string old = input("out.ply", "old");

  const auto summary = run({a, b}, "out.ply", {.overwrite = true});

  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().fault, Fault::kBadInput);
  EXPECT_EQ(read_text_file(old), "old");
  EXPECT_FALSE(std::filesystem::exists(old + ".part"));
}

TEST_F(ConvertTest, RefusesAnExistingOutputAndAnUnknownExtension) {
  const std::string a = input("a.las", las({.points = 2}));

  const std::string b = input("b.las", las({.points = 2}));
  EXPECT_EQ(run({b}, "a.las").error().fault, Fault::kFailed);
  EXPECT_EQ(run({a}, "b.xyzzy").error().fault, Fault::kUsage);
  EXPECT_EQ(run({directory_ / "missing.las"}, "b.las").error().fault, Fault::kFailed);
}

TEST_F(ConvertTest, AFileNeverReplacesItself) {
  const std::string a = input("a.las", las({.points = 2}));

  EXPECT_EQ(run({a}, "a.las", {.overwrite = true}).error().fault, Fault::kUsage);

  EXPECT_TRUE(read_text_file(a) == las({.points = 2}));
}

TEST_F(ConvertTest, StopsWhenToldTo) {
  class Stopping : public Monitor {
    bool stopping() const override { return true; }
  } monitor;
  const std::string a = input("a.las", las({.points = 2}));

  const auto summary = convert({a}, directory_ / "b.las", {}, monitor);

  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().fault, Fault::kInterrupted);
  expect_nothing_at("b.las");
}

TEST_F(ConvertTest, TakesMoreInputsThanFilesMayBeOpen) {
  const std::string a = input("a.las", las({.points = 2}));

  const ConvertSummary summary = expect_converted(std::vector<std::string>(3000, a), "out.las");

  EXPECT_EQ(summary.points_out, 6000u);
}

}  // namespace
}  // namespace pss::test
