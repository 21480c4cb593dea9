// Headers that the LAS writer carries on, corrects or makes anew.
#include <gtest/gtest.h>

#include <string>

#include "tests/io/formats/las/las_writer_fixture.h"

namespace pss::test {
namespace {

TEST_F(LasWriterTest, CopiesEveryFormatByteForByte) {
  for (int format = 0; format <= 10; ++format)
    for (int minor = format >= 6 ? 4 : format >= 4 ? 3 : 0; minor <= 4; ++minor) {
      LasFile file{.minor = minor,
                   .format = format,
                   .extra = 3,
                   .points = 5,
                   .vlrs = vlr("someone", 1, "content") + "pad",
                   .vlr_count = 1};
      if (minor == 4) {
        file.evlrs = evlr("someone", 2, "more");
        file.evlr_count = 1;
      }
      const std::string content = las(file);
      read(content);
      WriteOptions options = carried();
      options.same_points = true;

      EXPECT_TRUE(write(options, points_) == content) << minor << " " << format;
      EXPECT_TRUE(notes_.empty());
    }
}

TEST_F(LasWriterTest, CopiesLas15WithTheTimesOfItsHeader) {
  const std::string content = las({.minor = 5, .format = 7, .points = 4});
  read(content);
  WriteOptions options = carried();
  options.same_points = true;

  EXPECT_EQ(write(options, points_), content);
}

TEST_F(LasWriterTest, KeepsTheTimesOfALas15HeaderBesideNewAttributes) {
  read(las({.minor = 5, .format = 7, .points = 4}));
  append_value(header_.schema, field("Height", Type::kFloat32), 7);

  const std::string written = write(carried(), points_);

  EXPECT_EQ(get<std::uint8_t>(written, 25), 5);
  EXPECT_EQ(get<std::uint16_t>(written, 94), 393);
  EXPECT_EQ(get<double>(written, 375), 2.5e8);
  EXPECT_EQ(get<double>(written, 383), 1.5e8);
  EXPECT_EQ(get<std::uint16_t>(written, 391), 1500);
  read(written);
  EXPECT_EQ(points_.size(), 4u);
}

TEST_F(LasWriterTest, KeepsAWrongHeaderOnlyForTheSamePoints) {
  std::string content = las({.format = 1, .points = 4});
  put(content, 179, 1e9);                        // a bound that no point has
  put(content, 111 + 4 * 4, std::uint32_t{77});  // fifth returns that are not there
  read(content);
  WriteOptions options = carried();
  options.same_points = true;
  EXPECT_TRUE(write(options, points_) == content);

  options.same_points = false;
  const std::string honest = write(options, points_);

  EXPECT_EQ(get<double>(honest, 179), 3.0);
  EXPECT_EQ(get<std::uint32_t>(honest, 127), 0u);
  EXPECT_TRUE(honest.substr(227) == content.substr(227));
}

TEST_F(LasWriterTest, SaysThatKeptBoundsDoNotHoldThePoints) {
  std::string content = las({.format = 1, .points = 4});
  put(content, 179, 0.5);
  read(content);
  WriteOptions options = carried();
  options.same_points = true;

  EXPECT_TRUE(write(options, points_) == content);

  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("bounds"), std::string::npos);
}

TEST_F(LasWriterTest, RewritesCountsAndBoundsForOtherPoints) {
  for (const int minor : {2, 4}) {
    std::string content = las({.minor = minor, .format = 1, .points = 4});
    const std::size_t at = get<std::uint16_t>(content, 94);
    for (std::size_t i = 0; i < 4; ++i)  // returns 1, 2, 3, 4
      content[at + i * 28 + 14] = static_cast<char>(i + 1);
    read(content);
    points_.index.resize(2);
    points_.rows.resize(2 * header_.schema.row_size());

    const std::string out = write(carried(), points_);

    EXPECT_EQ(out.size(), content.size() - 2 * 28);
    EXPECT_EQ(get<std::uint32_t>(out, 107), 2u);
    EXPECT_EQ(get<std::uint32_t>(out, 111), 1u);
    EXPECT_EQ(get<std::uint32_t>(out, 115), 1u);
    EXPECT_EQ(get<std::uint32_t>(out, 119), 0u);
    const double bounds[] = {1, 0, 1000, 999, 2000.01, 2000};
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_DOUBLE_EQ(get<double>(out, 179 + 8 * i), bounds[i]) << i;
    if (minor == 4) {
      EXPECT_EQ(get<std::uint64_t>(out, 247), 2u);
      EXPECT_EQ(get<std::uint64_t>(out, 263), 1u);
    }
    EXPECT_EQ(out.substr(26, 68), content.substr(26, 68));  // system, software, dates
  }
}

TEST_F(LasWriterTest, FewerPointsThanAnnouncedAreCountedAndMoreAreRefused) {
  read(las({.points = 3}));
  WriteOptions options = carried();
  options.count = 10;
  EXPECT_EQ(get<std::uint32_t>(write(options, points_), 107), 3u);

  options.count = 2;
  EXPECT_NE(write(options, points_).find("found more points than the 2"), std::string::npos);
}

TEST_F(LasWriterTest, CountsAbove32BitsBecomeLas14) {
  read(las({.format = 1, .points = 3, .vlrs = vlr("someone", 9, "keep"), .vlr_count = 1}));
  WriteOptions options = carried();
  options.count = std::uint64_t{1} << 32;

  const std::string out = write(options, points_);

  EXPECT_EQ(out[25], 4);
  EXPECT_EQ(get<std::uint16_t>(out, 94), 375);
  EXPECT_EQ(get<std::uint32_t>(out, 96), 375u + 58u);
  EXPECT_EQ(get<std::uint64_t>(out, 247), 3u);
  EXPECT_EQ(out.substr(375, 58), vlr("someone", 9, "keep"));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("LAS 1.4"), std::string::npos);
}

TEST_F(LasWriterTest, DropsRecordsThatWouldLieAndSaysSo) {
  const LasFile file{.minor = 4,
                     .format = 6,
                     .points = 1,
                     .vlrs = vlr("copc", 1, std::string(160, 'c')) + vlr("someone", 9, "keep"),
                     .vlr_count = 2};
  read(las(file));

  const std::string out = write(carried(), points_);

  EXPECT_EQ(get<std::uint32_t>(out, 100), 1u);
  EXPECT_EQ(out.substr(375, 58), vlr("someone", 9, "keep"));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("'copc' 1"), std::string::npos);
}

TEST_F(LasWriterTest, DoesNotPointToWaveDataThatIsNotThere) {
  std::string content = las({.minor = 3, .format = 4, .points = 1});
  put(content, 6, std::uint16_t{0x2 | 0x1});
  put(content, 227, std::uint64_t{content.size()});
  read(content);

  const std::string out = write(carried(), points_);

  EXPECT_EQ(get<std::uint64_t>(out, 227), 0u);
  EXPECT_EQ(get<std::uint16_t>(out, 6), 1);
  ASSERT_FALSE(notes_.empty());
}

TEST_F(LasWriterTest, AnEmptyFileIsValid) {
  WriteOptions options;
  options.schema = Schema({field("GpsTime", Type::kFloat64)});

  read(write(options, {}));

  EXPECT_EQ(header_.count, 0u);
  EXPECT_EQ(points_.size(), 0u);
}

TEST_F(LasWriterTest, RefusesADamagedCarriedHeader) {
  read(las({.points = 1}));
  WriteOptions options = carried();
  for (std::size_t length = options.carry->head.size(); length-- > 1;) {
    options.carry->head.resize(length);
    EXPECT_FALSE(create_las(path_, options)) << length;
  }
}

}  // namespace
}  // namespace pss::test
