#include "stream/widths/widths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "stream/widths/widths_json.h"
#include "tests/stream/synth_store.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_value;
using test::Points;
using test::store_of;
using test::synth_points;

constexpr Method kMethod;

Spacing even_spacing(double spacing) {
  const double d16 = spacing / std::sqrt(std::numbers::pi / 16);
  return {spacing, d16, 0.8 * d16, 1.2 * d16, 4096};
}

TEST(Widths, AreTwoSpacingsAndThreeTimesThatWithoutAWord) {
  const ChosenWidths widths = choose_widths({}, kMethod, even_spacing(0.5));

  EXPECT_DOUBLE_EQ(widths.h, 1.0);
  EXPECT_DOUBLE_EQ(widths.radius, 3.0);
  EXPECT_EQ(widths.nearest, 0);
}

TEST(Widths, ReachFourWidthsForDegreeFour) {
  const ChosenWidths widths = choose_widths({.degree = 4}, Method{.degree = 4}, even_spacing(0.5));

  EXPECT_DOUBLE_EQ(widths.radius, 4.0);
}

TEST(Widths, FollowTheRadiusOrTheWidthThatIsGiven) {
  const ChosenWidths by_radius = choose_widths({.radius = 6}, kMethod, std::nullopt);
  const ChosenWidths by_h = choose_widths({.h = 2}, kMethod, std::nullopt);
  const ChosenWidths by_both = choose_widths({.radius = 6, .h = 1.5}, kMethod, std::nullopt);

  EXPECT_DOUBLE_EQ(by_radius.h, 2);
  EXPECT_DOUBLE_EQ(by_h.radius, 6);
  EXPECT_DOUBLE_EQ(by_both.radius / by_both.h, 4);
}

TEST(Widths, AreOneForTheWeightOfPcl) {
  const Method pcl{MlsOperator::kFast, WeightKind::kPcl};
  for (const auto& [options, radius] :
       {std::pair{WidthOptions{.radius = 6}, 6.0}, {WidthOptions{.h = 2}, 2.0}}) {
    const ChosenWidths widths = choose_widths(options, pcl, std::nullopt);

    EXPECT_EQ(widths.radius, radius);
    EXPECT_EQ(widths.h, radius);
  }
  const ChosenWidths measured = choose_widths({}, pcl, even_spacing(0.5));
  EXPECT_DOUBLE_EQ(measured.radius, 3) << "that of a Gaussian";
  EXPECT_DOUBLE_EQ(measured.h, 3);
}

TEST(Widths, AreOwnedByEachPointWhereTheSpacingVariesFourfold) {
  Spacing spacing = even_spacing(1);
  spacing.d16_high = 4.01 * spacing.d16_low;

  const ChosenWidths widths = choose_widths({}, kMethod, spacing);

  EXPECT_EQ(widths.nearest, 16);
  EXPECT_DOUBLE_EQ(widths.cap, 16 * spacing.d16);
  // h = 2 d16 sqrt(pi / 16), radius = 3 h.
  EXPECT_NEAR(widths.factor, 6 * std::sqrt(std::numbers::pi) / 4, 1e-12);
}

TEST(Widths, CapTheNearestAtTenSpacingsOrAtTheRadius) {
  EXPECT_DOUBLE_EQ(choose_widths({.knn = 30}, kMethod, even_spacing(0.5)).cap, 5.0);
  EXPECT_DOUBLE_EQ(choose_widths({.radius = 2, .knn = 30}, kMethod, std::nullopt).cap, 2.0);
}

TEST(Widths, MoveNothingWhereThereIsNoSpacing) {
  const ChosenWidths widths = choose_widths({}, kMethod, std::nullopt);

  EXPECT_EQ(widths.radius, 0);
  EXPECT_NE(widths.why.find("17"), std::string::npos);
}

ChosenWidths chosen_for(const Store& store, const WidthOptions& options = {}) {
  MemoryBudget budget(512u << 20, 1);
  Monitor monitor;
  return expect_value(choose_widths(store, options, Method{}, budget, monitor));
}

TEST(Widths, OfNoisyScansLeaveNearlyTheLeastError) {
  test::TemporaryDirectory folder;
  struct Case {
    Surface surface;
    double noise, least, most;  ///< h over spacing, by the balance of noise and curvature
  };
  for (const Case& c : {Case{Torus{}, 0, 2, 2}, Case{Torus{}, 0.1, 3.5, 4.5},
                        Case{Torus{}, 0.3, 4.3, 5.5}, Case{Terrain{}, 0.1, 3.3, 4.3},
                        Case{Terrain{}, 0.3, 4.3, 5.5}, Case{Sphere{}, 0.1, 5.5, 6}}) {
    const Points points = synth_points(c.surface, 20000, c.noise);

    const ChosenWidths widths = chosen_for(store_of(points, folder / "s.pss"));

    const double spacing = widths.spacing->spacing;
    EXPECT_GE(widths.h / spacing, c.least) << widths.why;
    EXPECT_LE(widths.h / spacing, c.most) << widths.why;
    double best = HUGE_VAL;
    for (const double multiple : {2, 3, 4, 5, 6})
      best = std::min(best, test::error_at(points, c.surface, multiple * spacing));
    EXPECT_LT(test::error_at(points, c.surface, widths.h), 1.15 * best) << widths.why;
  }
}

/// Two squares of 50 x 50 points, a unit apart and six, with noise of 0.3 of that.
Points two_spacings() {
  test::Random random(8);
  const Lattice lattice{{0.001, 0.001, 0.001}, {0, 0, 0}};
  std::vector<World3> world;
  for (const double step : {1.0, 6.0})
    for (int x = 0; x < 50; ++x)
      for (int y = 0; y < 50; ++y)
        world.push_back({step * (100 + x + random.uniform(-0.2, 0.2)),
                         step * (y + random.uniform(-0.2, 0.2)), step * 0.3 * random.normal()});
  return {lattice, test::on_lattice_sorted(lattice, world)};
}

TEST(Widths, FollowEachPointsOwnSpacingByTheSameRule) {
  test::TemporaryDirectory folder;

  const ChosenWidths widths = chosen_for(store_of(two_spacings(), folder / "s.pss"));

  ASSERT_TRUE(widths.spacing->varying());
  EXPECT_NEAR(widths.noise->sigma, 0.3, 0.03);
  EXPECT_GT(widths.choice.multiple, 4);
  EXPECT_DOUBLE_EQ(widths.factor, 3 * widths.choice.multiple * spacing_of_d16(1));
}

TEST(Widths, KeepTwoSheetsApart) {
  test::TemporaryDirectory folder;
  test::Random random(9);
  const Lattice lattice{{0.001, 0.001, 0.001}, {0, 0, 0}};
  for (const auto& [apart, most] : {std::pair{4.0, 2.0}, {6.0, 6 / 2.25}}) {
    std::vector<World3> world;
    for (int x = 0; x < 60; ++x)
      for (int y = 0; y < 60; ++y)
        for (const double z : {0.0, apart})
          world.push_back({x + random.uniform(-0.2, 0.2), y + random.uniform(-0.2, 0.2),
                           z + 0.2 * random.normal()});
    const Points points{lattice, test::on_lattice_sorted(lattice, world)};

    const ChosenWidths widths = chosen_for(store_of(points, folder / "s.pss"));

    EXPECT_EQ(widths.choice.limit, WidthLimit::kSheets) << widths.why;
    EXPECT_LE(widths.h, 1.02 * most * widths.spacing->spacing) << widths.why;
  }
}

TEST(Widths, MeasureNothingThatIsNotAskedFor) {
  test::TemporaryDirectory folder;
  const Store store = store_of(synth_points(Torus{}, 2000, 0.1), folder / "s.pss");

  EXPECT_FALSE(chosen_for(store, {.h = 0.1}).spacing);
  EXPECT_TRUE(chosen_for(store, {.knn = 20}).spacing);
  EXPECT_FALSE(chosen_for(store, {.knn = 20}).noise);
  EXPECT_TRUE(chosen_for(store).noise);
}

TEST(Widths, SayWhatWasChosenWhyAndWhatItCosts) {
  test::TemporaryDirectory folder;
  const ChosenWidths widths =
      chosen_for(store_of(synth_points(Sphere{}, 20000, 0.3), folder / "s.pss"));

  EXPECT_NEAR(widths.neighbours,
              std::numbers::pi * std::pow(widths.radius / widths.spacing->spacing, 2), 1e-6);
  for (const char* word : {"spacing", "noise 0.29", "the widest", "1018 neighbours"})
    EXPECT_NE(widths.why.find(word), std::string::npos) << word << ": " << widths.why;
}

TEST(Widths, AreTheSameAfterAWayThroughJson) {
  test::TemporaryDirectory folder;
  const ChosenWidths widths =
      chosen_for(store_of(synth_points(Torus{}, 5000, 0.2), folder / "s.pss"));

  const ChosenWidths again = widths_from_json(widths_json(widths));

  EXPECT_EQ(widths_json(again).dump(), widths_json(widths).dump());
  EXPECT_EQ(again.choice.limit, widths.choice.limit);
  EXPECT_EQ(again.noise->trials.size(), widths.noise->trials.size());
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
