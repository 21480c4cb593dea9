// What a LAS file says is found without holding its head, and is what the whole head says.
#include "io/formats/las/las_survey.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/io/formats/las/las_reader_fixture.h"

namespace pss::test {
namespace {

constexpr std::string_view kWkt = R"(GEOGCS["a",DATUM["WGS_1984"],AUTHORITY["EPSG","4326"]])";

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

class LasSurveyTest : public LasReaderTest {
 protected:
  CloudHeader surveyed(const std::string& content) {
    write_text_file(path_, content);
    auto reader = open_las_holding(HeadBytes::kLeft, path_);
    EXPECT_TRUE(reader) << reader.error().message;
    return reader ? (*reader)->header() : CloudHeader{};
  }
};

TEST_F(LasSurveyTest, FindsAmongManyRecordsWhatTheWholeHeadSays) {
  const std::string many = repeated(vlr("someone", 9, std::string(60000, 'x')), 30);
  const std::string content =
      las({.minor = 4,
           .format = 6,
           .extra = 9,
           .vlrs = many + vlr("LASF_Spec", 4, descriptor(4, "depth")) + many +
                   vlr("LASF_Projection", 2112, kWkt) + many,
           .vlr_count = 92,
           .evlrs = evlr("mine", 1, std::string(100000, 'y')) + evlr("copc", 1, "no"),
           .evlr_count = 2});

  const CloudHeader left = surveyed(content);
  const CloudHeader kept = header_of(content);

  EXPECT_EQ(left.crs, "EPSG:4326");
  EXPECT_TRUE(left.schema.dimension("depth").has_value());
  EXPECT_EQ(left.schema, kept.schema);
  EXPECT_EQ(left.warnings, kept.warnings);
  EXPECT_EQ(left.carry, Carry{});
  const std::size_t head = 375 + 90 * 60054 + 54 + 192 + 54 + kWkt.size();
  EXPECT_EQ(kept.carry.head.size(), head);
  EXPECT_EQ(kept.carry.tail.size(), 100060u);
  EXPECT_EQ(left.carry_size, head + 100060);
  EXPECT_EQ(kept.carry_size, left.carry_size);
}

TEST_F(LasSurveyTest, TellsRecordsThatDoNotLieWholeBeforeThePoints) {
  const std::string two = vlr("a", 1, "content") + vlr("b", 1, "more");
  const std::string content =
      las({.points = 2, .vlrs = two.substr(0, two.size() - 1), .vlr_count = 2});

  const CloudHeader left = surveyed(content);

  ASSERT_EQ(left.warnings.size(), 1u);
  EXPECT_NE(left.warnings[0].find("found 1 VLRs"), std::string::npos) << left.warnings[0];
}

TEST_F(LasSurveyTest, TellsCoordinateSystemsOfManyBytesApart) {
  const auto with = [&](char last) {
    return surveyed(las({.minor = 4,
                         .format = 6,
                         .evlrs = evlr("LASF_Projection", 2112,
                                       "GEOGCS[\"" + std::string(200000, 'a') + last + "\"]"),
                         .evlr_count = 1}));
  };
  EXPECT_EQ(with('b').crs, with('b').crs);
  EXPECT_NE(with('b').crs, with('c').crs);
  EXPECT_LT(with('b').crs.size(), 100u);
}

TEST_F(LasSurveyTest, CountsDroppedRecordsBeyondTheFirstFew) {
  const CloudHeader left = surveyed(las({.minor = 4,
                                         .format = 6,
                                         .evlrs = repeated(evlr("copc", 1, "no"), 1000),
                                         .evlr_count = 1000}));

  ASSERT_EQ(left.warnings.size(), 17u);
  EXPECT_EQ(left.warnings.back(), "984 more EVLRs are dropped");
}

}  // namespace
}  // namespace pss::test
