#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "io/formats/table.h"
#include "io/open.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

TEST(OpenReader, GoesByContentAndNotByName) {
  TemporaryDirectory directory;
  write_text_file(directory / "a.txt", las({.points = 1}));
  write_text_file(directory / "b.las", "1 2 3\n4 5 6\n");
  write_text_file(directory / "c",
                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                  "property float y\nproperty float z\nend_header\n1 2 3\n");

  EXPECT_EQ((*open_reader(directory / "a.txt"))->header().format, "LAS");
  EXPECT_EQ((*open_reader(directory / "b.las"))->header().format, "text");
  EXPECT_EQ((*open_reader(directory / "c"))->header().format, "PLY");
}

TEST(OpenReader, NamesWhatItCannotRead) {
  TemporaryDirectory directory;
  const auto message = [&](const std::string& content) {
    write_text_file(directory / "file", content);
    const auto reader = open_reader(directory / "file");
    EXPECT_FALSE(reader);
    if (reader) return std::string();
    EXPECT_EQ(reader.error().fault, Fault::kBadInput);
    return reader.error().message;
  };
  EXPECT_NE(message("").find("empty file"), std::string::npos);
  EXPECT_NE(message("ASTM-E57rest").find("E57"), std::string::npos);
  EXPECT_NE(message("# .PCD v0.7 - Point Cloud Data\n").find("PCD"), std::string::npos);
  EXPECT_NE(message("OFF\n1 0 0\n").find("OFF"), std::string::npos);
  EXPECT_NE(message(std::string(100, '\x01')).find("file: offset 0"), std::string::npos);
  EXPECT_NE(message(std::string("1 2 3\n\0", 7)).find("no known format"), std::string::npos);
}

TEST(OpenReader, MissingFileIsNoBadInput) {
  TemporaryDirectory directory;

  EXPECT_EQ(open_reader(directory / "missing.las").error().fault, Fault::kFailed);
}

TEST(OpenReader, BrokenFilesGiveTheirPointsOrARefusal) {
  PSS_REQUIRE_DATA();
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "broken")) {
    const auto points = open_and_read(open_reader, entry.path());
    expect_bad_input_or_points(points);
    if (points) continue;
    EXPECT_NE(points.error().message.find(entry.path()), std::string::npos)
        << points.error().message;
  }
}

TEST(FormatFor, GoesByExtensionInAnyCase) {
  EXPECT_EQ(*format_for("a/b.las"), &kLasFormat);
  EXPECT_EQ(*format_for("a.b/c.PLY"), &kPlyFormat);
  for (const char* name : {"a.xyz", "a.txt", "a.csv", "a.asc", "a.Pts"})
    EXPECT_EQ(*format_for(name), &kTextFormat);
  for (const char* name : {"a", "a.laz", "las", ".las", "a.las/b"})
    EXPECT_EQ(format_for(name).error().fault, Fault::kUsage);
}

}  // namespace
}  // namespace pss::test
