#include "core/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/sin_cos.h"

namespace pss::test {
namespace {

/// How many units in the last place of `expected` lie between the two.
double ulps(double value, double expected) {
  if (value == expected) return 0;
  const double unit = std::nextafter(std::abs(expected), std::numeric_limits<double>::infinity()) -
                      std::abs(expected);
  return std::abs(value - expected) / unit;
}

/// The worst error of `ours` against `theirs` over `count` places from `low` to `high`.
template <class Ours, class Theirs>
double worst(Ours ours, Theirs theirs, double low, double high, int count) {
  double most = 0;
  for (int i = 0; i <= count; ++i) {
    const double x = low + (high - low) * i / count;
    most = std::max(most, ulps(ours(x), theirs(x)));
  }
  return most;
}

const auto kExp = [](double x) { return pss::exp(x); };
const auto kLog = [](double x) { return pss::log(x); };
const auto kSin = [](double x) { return pss::sin(x); };
const auto kCos = [](double x) { return pss::cos(x); };
const auto kLibExp = [](double x) { return std::exp(x); };
const auto kLibLog = [](double x) { return std::log(x); };
const auto kLibSin = [](double x) { return std::sin(x); };
const auto kLibCos = [](double x) { return std::cos(x); };

TEST(Exp, IsWithinTwoUlpOfTheLibrary) {
  EXPECT_LE(worst(kExp, kLibExp, -706.9, 709.7, 200000), 2);
  EXPECT_LE(worst(kExp, kLibExp, -30, 0, 200000), 2);
  EXPECT_LE(worst(kExp, kLibExp, -1e-3, 1e-3, 20000), 2);
}

TEST(Exp, IsExactlyOneAtZero) { EXPECT_EQ(pss::exp(0), 1); }

TEST(Exp, IsZeroFarBelowAndInfiniteFarAbove) {
  EXPECT_EQ(pss::exp(-707.1), 0);
  EXPECT_EQ(pss::exp(-1e300), 0);
  EXPECT_EQ(pss::exp(-std::numeric_limits<double>::infinity()), 0);
  EXPECT_EQ(pss::exp(710), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(pss::exp(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Log, IsWithinTwoUlpOfTheLibrary) {
  EXPECT_LE(worst(kLog, kLibLog, 1e-6, 4, 200000), 2);
  EXPECT_LE(worst(kLog, kLibLog, 0.99, 1.01, 200000), 2);
  EXPECT_LE(worst(kLog, kLibLog, 1, 1e9, 100000), 2);
  for (double x = 0x1p-1074; x < 0x1p1020; x *= 7.3) EXPECT_LE(ulps(pss::log(x), std::log(x)), 2);
}

TEST(Log, HandlesTheEdgesOfItsDomain) {
  EXPECT_EQ(pss::log(1), 0);
  EXPECT_EQ(pss::log(0), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(pss::log(-1)));
  EXPECT_EQ(pss::log(std::numeric_limits<double>::infinity()),
            std::numeric_limits<double>::infinity());
}

TEST(SinCos, AreWithinTwoUlpOfTheLibrary) {
  for (const double range : {1e-3, 1.0, 7.0, 100.0, 1.5e6}) {
    EXPECT_LE(worst(kSin, kLibSin, -range, range, 100000), 2) << range;
    EXPECT_LE(worst(kCos, kLibCos, -range, range, 100000), 2) << range;
  }
}

TEST(SinCos, TogetherGiveTheSameBitsAsApart) {
  for (int k = -200000; k <= 200000; ++k) {
    const double x = k * 1.0e-4 + k * 3.7e-9;
    const auto [sine, cosine] = sin_cos(x);
    ASSERT_EQ(sine, pss::sin(x)) << x;
    ASSERT_EQ(cosine, pss::cos(x)) << x;
  }
}

TEST(SinCos, KeepTheirPrecisionNextToMultiplesOfAQuarterTurn) {
  for (int k = 1; k < 100000; ++k) {
    const double x = k * (std::numbers::pi / 2);
    ASSERT_LE(ulps(pss::sin(x), std::sin(x)), 2) << k;
    ASSERT_LE(ulps(pss::cos(x), std::cos(x)), 2) << k;
  }
}

}  // namespace
}  // namespace pss::test
