#include "apps/progress_view.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace pss::test {
namespace {

Snapshot halfway() {
  return {.stage = "smooth",
          .points = 1'000'000,
          .total_points = 2'000'000,
          .tiles = 4,
          .total_tiles = 8,
          .seconds = 65,
          .points_per_second = 200'000,
          .resident_bytes = 143u << 20};
}

}  // namespace

TEST(ProgressView, TimeLeftIsWhatIsLeftByTheRate) {
  EXPECT_DOUBLE_EQ(halfway().seconds_left().value(), 5);
}

TEST(ProgressView, ThereIsNoTimeLeftWithoutATotalOrARate) {
  Snapshot unknown = halfway();
  unknown.total_points = 0;
  Snapshot stuck = halfway();
  stuck.points_per_second = 0;
  EXPECT_FALSE(unknown.seconds_left());
  EXPECT_FALSE(stuck.seconds_left());
}

TEST(ProgressView, PointsBeyondThePromisedTotalLeaveNoTime) {
  Snapshot beyond = halfway();
  beyond.points = 3'000'000;
  EXPECT_DOUBLE_EQ(beyond.seconds_left().value(), 0);
  EXPECT_NE(bar_line(beyond, 200).find("100%"), std::string::npos);
}

TEST(ProgressView, ABarIsHalfFullHalfway) {
  EXPECT_NE(bar_line(halfway(), 200).find("[##########----------]  50%"), std::string::npos);
}

TEST(ProgressView, ABarFitsTheTerminal) { EXPECT_LE(bar_line(halfway(), 40).size(), 40u); }

TEST(ProgressView, APlainLineHasStageTilesRateTimeAndMemory) {
  EXPECT_EQ(plain_line(halfway()),
            "[1:05] smooth: 50%, 1.00 M of 2.00 M points, 4/8 tiles, 200 k/s, 0:05 left, 143 MiB");
}

TEST(ProgressView, AJsonLineHasTheDocumentedKeys) {
  const nlohmann::json line = nlohmann::json::parse(json_line(halfway()));
  EXPECT_EQ(line["event"], "progress");
  EXPECT_EQ(line["stage"], "smooth");
  EXPECT_EQ(line["points"], 1'000'000);
  EXPECT_EQ(line["total_points"], 2'000'000);
  EXPECT_EQ(line["tiles"], 4);
  EXPECT_EQ(line["total_tiles"], 8);
  EXPECT_EQ(line["points_per_second"], 200'000);
  EXPECT_EQ(line["seconds_left"], 5);
  EXPECT_EQ(line["resident_bytes"], 143 << 20);
}

TEST(ProgressView, ANoteThatIsNotUtf8IsStillJson) {
  EXPECT_EQ(nlohmann::json::parse(json_note("a\xff"))["event"], "note");
}

TEST(ProgressView, ShortTextsRoundToThreeDigits) {
  EXPECT_EQ(short_count(0), "0");
  EXPECT_EQ(short_count(999), "999");
  EXPECT_EQ(short_count(999.9), "1.00 k");
  EXPECT_EQ(short_count(99'960), "100 k");
  EXPECT_EQ(short_count(1.5e9), "1.50 G");
  EXPECT_EQ(short_time(59.6), "1:00");
  EXPECT_EQ(short_time(7384), "2:03:04");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(grouped(123), "123");
}

}  // namespace pss::test
