#include "stream/widths/width_rule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pss {
namespace {

constexpr double kKept = 0.631;  ///< of noise, degree 3

/// Noise on a surface that departs from fits by `shape` h^4.
Noise noise_on(double sigma, double shape) {
  Noise noise;
  noise.sample = 1024;
  noise.sigma = sigma;
  noise.first = 0;
  noise.kept = kKept;
  noise.order = 4;
  for (std::size_t k = 0; k < kTriedWidths.size(); ++k) {
    const double h = kTriedWidths[k];
    WidthTrial trial{h, true, 1, sigma, 0.02 * h, 0, 0};
    if (k + 1 < kTriedWidths.size())
      trial.change = shape * (std::pow(kTriedWidths[k + 1], 4) - std::pow(h, 4));
    noise.trials.push_back(trial);
  }
  return noise;
}

TEST(WidthRule, FindsTheLeastErrorOfNoiseAndShape) {
  for (const double best : {2.5, 3.0, 3.7, 4.4, 5.1, 5.9}) {
    // The sum of (c sigma / h)^2 and (b h^4)^2 is least where 4 b^2 h^10 = (c sigma)^2.
    const double shape = kKept * 0.2 / (2 * std::pow(best, 5));

    const WidthChoice choice = choose_width(noise_on(0.2, shape));

    EXPECT_NEAR(choice.multiple, best, 1e-6);
    EXPECT_EQ(choice.limit, WidthLimit::kShape);
    EXPECT_NEAR(choice.error, kKept * 0.2 / best, 1e-6);
  }
}

TEST(WidthRule, StaysBetweenTwoAndSixSpacings) {
  EXPECT_EQ(choose_width(noise_on(0.2, 1)).multiple, 2);
  EXPECT_EQ(choose_width(noise_on(0.5, 0)).multiple, 6);
  EXPECT_EQ(choose_width(noise_on(0.5, 0)).limit, WidthLimit::kNone);
}

TEST(WidthRule, AsksNoNeighboursForNoiseThatIsNextToNothing) {
  EXPECT_EQ(choose_width(noise_on(0, 0)).multiple, 2);
  EXPECT_EQ(choose_width(noise_on(0.01, 0)).multiple, 2);
  EXPECT_EQ(choose_width(noise_on(0.03, 0)).limit, WidthLimit::kNoise);
  // Equal ratios of noise are equal ratios of width: the geometric means belong together.
  EXPECT_NEAR(choose_width(noise_on(std::sqrt(0.001), 0)).multiple, std::sqrt(12), 1e-9);
  EXPECT_NEAR(choose_width(noise_on(0.1, 0)).multiple, 6, 1e-9);
}

TEST(WidthRule, KeepsASecondSheetOut) {
  Noise noise = noise_on(0.3, 0);
  noise.apart = 9;

  EXPECT_DOUBLE_EQ(choose_width(noise).multiple, 4);  // 9 / 2.25
  EXPECT_EQ(choose_width(noise).limit, WidthLimit::kSheets);
  noise.apart = 3;
  EXPECT_EQ(choose_width(noise).multiple, 2);
}

TEST(WidthRule, StaysWellBelowTheRadiusOfCurvature) {
  Noise noise = noise_on(0.3, 0);
  for (WidthTrial& trial : noise.trials) trial.bend = trial.width / 9;  // k = 1/9 a spacing

  EXPECT_DOUBLE_EQ(choose_width(noise).multiple, 4.5);  // h k = 1/2
  EXPECT_EQ(choose_width(noise).limit, WidthLimit::kCurvature);
}

TEST(WidthRule, StaysWhereFitsAreInside) {
  Noise noise = noise_on(0.3, 0);
  for (WidthTrial& trial : noise.trials) trial.usable = trial.width < 5 ? 0.8 : 0.2;

  EXPECT_NEAR(choose_width(noise).multiple, 4 + 2.0 / 3, 1e-12);  // 0.4, half of 0.8
  EXPECT_EQ(choose_width(noise).limit, WidthLimit::kExtent);
}

TEST(WidthRule, IsContinuousInNoiseAndShape) {
  for (double sigma = 0.005; sigma < 0.6; sigma *= 1.01)
    for (const double shape : {0.0, 1e-5, 1e-4, 1e-3}) {
      const double here = choose_width(noise_on(sigma, shape)).multiple;
      EXPECT_NEAR(choose_width(noise_on(1.01 * sigma, shape)).multiple, here, 0.05);
      EXPECT_NEAR(choose_width(noise_on(sigma, 1.01 * shape)).multiple, here, 0.05);
    }
}

TEST(WidthRule, IsTwoSpacingsWhereNoSurfaceIsSeen) {
  EXPECT_EQ(choose_width(Noise{}).multiple, 2);
  EXPECT_EQ(choose_width(Noise{}).limit, WidthLimit::kNoSurface);
}

TEST(WidthRule, BeginsAtTheFirstWidthThatSeesASurface) {
  Noise noise = noise_on(1, 0);
  noise.first = 2;
  noise.apart = 5;  // would be 2.2 spacings

  EXPECT_EQ(choose_width(noise).multiple, 4);
}

}  // namespace
}  // namespace pss
