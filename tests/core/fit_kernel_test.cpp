#include "core/fit_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/scan.h"

namespace pss::test {
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

TEST(FitKernel, OfAMeanHasTheVarianceOfItsEffectiveSamples) {
  for (const WeightKind weight : kWeightKinds) {
    const FitKernel kernel(weight, 0, 3);

    EXPECT_NEAR(kernel.noise_sq() * kernel.samples(), 1, 1e-6) << name_of(weight);
  }
}

constexpr double kNarrow = 2, kWide = 3;

/// A unit grid with noise as heights.
Scan noisy_grid(int side, double noise) {
  Random random(7);
  std::vector<SurfacePoint> samples;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      samples.push_back({{1.0 * i, 1.0 * j, noise * random.normal()}, {0, 0, 1}});
  return sorted_scan({{0x1p-30, 0x1p-30, 0x1p-30}, {0, 0, 0}}, samples);
}

/// Places between the grid's lines, 6 apart, `border` from its edges.
std::vector<Query> queries_on(int side, double border) {
  std::vector<Query> queries;
  for (double x = border; x < side - border; x += 6)
    for (double y = border; y < side - border; y += 6)
      queries.push_back({{static_cast<std::int64_t>((std::floor(x) + 0.3) * 0x1p30),
                          static_cast<std::int64_t>((std::floor(y) + 0.4) * 0x1p30), 0}});
  return queries;
}

class FitKernelOfDegree : public testing::TestWithParam<int> {};

TEST_P(FitKernelOfDegree, PredictsWhatProjectionsMakeOfNoise) {
  const int degree = GetParam();
  const double factor = radius_factor(degree);
  const double noise = 1e-3;
  const Scan scan = noisy_grid(360, noise);
  const std::vector<Query> queries = queries_on(360, factor * kWide + 1);
  const auto at = [&](double h) {
    return ScanProjector(scan, {h, factor * h}, levin(degree))(queries);
  };
  const std::vector<Projection> near = at(kNarrow);
  const std::vector<Projection> wide = at(kWide);
  double height_sq = 0, residual_sq = 0, difference_sq = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const double height = near[i].displacement[2] / noise;
    const double change = height - wide[i].displacement[2] / noise;
    const double residual = near[i].residual / noise;
    height_sq += height * height / static_cast<double>(queries.size());
    difference_sq += change * change / static_cast<double>(queries.size());
    residual_sq += residual * residual / static_cast<double>(queries.size());
  }
  const FitKernel kernel(WeightKind::kGaussian, degree, factor);
  // The plane takes up what a polynomial of degree 1 would.
  const FitKernel absorbing(WeightKind::kGaussian, std::max(degree, 1), factor);

  // A mean of some 3,000 squares is known to 2.6 % (one standard deviation).
  EXPECT_NEAR(height_sq / (kernel.noise_sq() / (kNarrow * kNarrow)), 1, 0.1);
  EXPECT_NEAR(difference_sq / kernel.difference_sq(kNarrow, kWide), 1, 0.1);
  EXPECT_NEAR(residual_sq, 1 - absorbing.absorbed() / (kNarrow * kNarrow), 0.01);
}

INSTANTIATE_TEST_SUITE_P(All, FitKernelOfDegree, testing::Range(0, 5));

}  // namespace
}  // namespace pss::test
