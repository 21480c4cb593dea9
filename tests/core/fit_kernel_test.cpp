#include "core/fit_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/polynomial.h"
#include "tests/support/cloud.h"

namespace pss {
namespace {

using std::numbers::pi;

TEST(FitKernel, HasTheKnownNoiseConstants) {
  // Of the whole Gaussian; at R = 3 h those of degree 4 are 4 to 7 % higher.
  for (const auto& [degree, constant] :
       {std::pair{0, 0.399}, {1, 0.399}, {2, 0.631}, {3, 0.631}, {4, 0.810}})
    EXPECT_NEAR(std::sqrt(FitKernel(WeightKind::kGaussian, degree, 6).noise_sq()), constant, 0.001)
        << degree;
}

TEST(FitKernel, OfTheMeanIsTheWeightItself) {
  const FitKernel kernel(WeightKind::kGaussian, 0, 6);

  // theta / pi: the integrals of Gaussians.
  EXPECT_NEAR(kernel.samples(), 2 * pi, 1e-3);
  EXPECT_NEAR(kernel.absorbed(), 1 / (2 * pi), 1e-4);
  EXPECT_NEAR(kernel.difference_sq(2, 3), (1 / 4.0 + 1 / 9.0 - 4 / 13.0) / (2 * pi), 1e-4);
}

TEST(FitKernel, DiffersNothingBetweenEqualWidths) {
  for (const WeightKind weight : kWeightKinds) {
    const FitKernel kernel(weight, 3, 3);

    EXPECT_EQ(kernel.difference_sq(2, 2), 0);
    EXPECT_DOUBLE_EQ(kernel.difference_sq(2, 4), kernel.difference_sq(4, 2));
  }
}

/// A unit grid about a point between its lines, with noise as heights.
Offsets noisy_grid(test::Random& random, double half) {
  Offsets grid;
  for (double x = -half + 0.3; x < half; ++x)
    for (double y = -half + 0.4; y < half; ++y) {
      grid.x.push_back(x);
      grid.y.push_back(y);
      grid.z.push_back(1e-3 * random.normal());
    }
  return grid;
}

TEST(FitKernel, OfAMeanHasTheVarianceOfItsEffectiveSamples) {
  for (const WeightKind weight : kWeightKinds) {
    const FitKernel kernel(weight, 0, 3);

    EXPECT_NEAR(kernel.noise_sq() * kernel.samples(), 1, 1e-6) << name_of(weight);
  }
}

class FitKernelOfDegree : public testing::TestWithParam<int> {};

TEST_P(FitKernelOfDegree, PredictsWhatFitsMakeOfNoiseOnAGrid) {
  const int degree = GetParam();
  const double radius = degree == 4 ? 4 : 3;
  const double h = 2, wide = 3;
  test::Random random(7);
  double height_sq = 0, residual_sq = 0, difference_sq = 0;
  constexpr int kTrials = 3000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Offsets grid = noisy_grid(random, radius * wide + 1);
    const auto map_at = [&](double width) {
      return fit_local_map({grid, 1 / width, TaperedGaussian(radius)}, Frame{}, 0, radius, degree);
    };
    const LocalMap near = map_at(h);
    const double height = 1e3 * h * near.coefficient(0, 0);
    const double wider = 1e3 * wide * map_at(wide).coefficient(0, 0);
    height_sq += height * height / kTrials;
    difference_sq += (height - wider) * (height - wider) / kTrials;
    residual_sq += 1e6 * h * h * near.residual * near.residual / kTrials;
  }
  const FitKernel kernel(WeightKind::kGaussian, degree, radius);

  // A mean of 3,000 squares is known to 2.6 % (one standard deviation).
  EXPECT_NEAR(height_sq / (kernel.noise_sq() / (h * h)), 1, 0.1);
  EXPECT_NEAR(difference_sq / kernel.difference_sq(h, wide), 1, 0.1);
  EXPECT_NEAR(residual_sq, 1 - kernel.absorbed() / (h * h), 0.02);
}

INSTANTIATE_TEST_SUITE_P(All, FitKernelOfDegree, testing::Range(0, 5));

}  // namespace
}  // namespace pss
