#include "stream/widths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace pss {
namespace {

Spacing even_spacing(double spacing) {
  const double d16 = spacing / std::sqrt(std::numbers::pi / 16);
  return {spacing, d16, 0.8 * d16, 1.2 * d16, 4096};
}

TEST(Widths, AreTwoSpacingsAndThreeTimesThatWithoutAWord) {
  const ChosenWidths widths = choose_widths({}, even_spacing(0.5));

  EXPECT_DOUBLE_EQ(widths.h, 1.0);
  EXPECT_DOUBLE_EQ(widths.radius, 3.0);
  EXPECT_EQ(widths.nearest, 0);
}

TEST(Widths, ReachFourWidthsForDegreeFour) {
  const ChosenWidths widths = choose_widths({.degree = 4}, even_spacing(0.5));

  EXPECT_DOUBLE_EQ(widths.radius, 4.0);
}

TEST(Widths, FollowTheRadiusOrTheWidthThatIsGiven) {
  const ChosenWidths by_radius = choose_widths({.radius = 6}, std::nullopt);
  const ChosenWidths by_h = choose_widths({.h = 2}, std::nullopt);
  const ChosenWidths by_both = choose_widths({.radius = 6, .h = 1.5}, std::nullopt);

  EXPECT_DOUBLE_EQ(by_radius.h, 2);
  EXPECT_DOUBLE_EQ(by_h.radius, 6);
  EXPECT_DOUBLE_EQ(by_both.radius / by_both.h, 4);
}

TEST(Widths, AreOwnedByEachPointWhereTheSpacingVariesFourfold) {
  Spacing spacing = even_spacing(1);
  spacing.d16_high = 4.01 * spacing.d16_low;

  const ChosenWidths widths = choose_widths({}, spacing);

  EXPECT_EQ(widths.nearest, 16);
  EXPECT_DOUBLE_EQ(widths.cap, 16 * spacing.d16);
  // h = 2 d16 sqrt(pi / 16), radius = 3 h.
  EXPECT_NEAR(widths.factor, 6 * std::sqrt(std::numbers::pi) / 4, 1e-12);
}

TEST(Widths, CapTheNearestAtTenSpacingsOrAtTheRadius) {
  EXPECT_DOUBLE_EQ(choose_widths({.knn = 30}, even_spacing(0.5)).cap, 5.0);
  EXPECT_DOUBLE_EQ(choose_widths({.radius = 2, .knn = 30}, std::nullopt).cap, 2.0);
}

TEST(Widths, MoveNothingWhereThereIsNoSpacing) {
  const ChosenWidths widths = choose_widths({}, std::nullopt);

  EXPECT_EQ(widths.radius, 0);
  EXPECT_NE(widths.why.find("17"), std::string::npos);
}

TEST(Widths, RefuseWhatMakesNoSense) {
  for (const WidthOptions& options :
       {WidthOptions{.radius = 1, .h = 2}, WidthOptions{.radius = -1}, WidthOptions{.h = 0},
        WidthOptions{.radius = NAN}, WidthOptions{.h = 1, .knn = 3}, WidthOptions{.knn = 0},
        WidthOptions{.degree = 5}, WidthOptions{.degree = -1}}) {
    const Result<void> checked = check_widths(options);

    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().fault, Fault::kUsage);
  }
  EXPECT_TRUE(check_widths({.radius = 2, .h = 2}));
}

}  // namespace
}  // namespace pss
