// Damaged and hostile LAS files end in their points or in a refusal that says why.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <limits>
#include <span>
#include <string>

#include "io/file/file.h"
#include "tests/io/formats/las/las_reader_fixture.h"

namespace pss::test {
namespace {

class LasRefusals : public LasReaderTest {};

TEST_F(LasRefusals, EveryTruncationIsRefused) {
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

TEST_F(LasRefusals, EveryHostileByteEndsInPointsOrARefusal) {
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
  auto victim = File::open_to_write(path_);
  const auto bytes = std::as_bytes(std::span(whole));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const unsigned value : {0x00u, 0x7Fu, 0x80u, 0xFFu}) {
      ASSERT_TRUE(victim->write(at, std::array{static_cast<std::byte>(value)}));
      expect_bad_input_or_points(open_and_read(open_las, path_));
    }
    ASSERT_TRUE(victim->write(at, bytes.subspan(at, 1)));
  }
}

TEST_F(LasRefusals, RefusesHostileHeadersByFieldFoundAndExpected) {
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

TEST_F(LasRefusals, RefusesEvlrsThatReachPastTheEnd) {
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

TEST_F(LasRefusals, FileThatShrinksWhileItIsReadIsBadInput) {
  const auto reader = open(las({.points = 4}));
  std::filesystem::resize_file(path_, 227 + 3 * 20);

  const auto points = read_all(**reader);

  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().fault, Fault::kBadInput);
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
