#include "io/points/numbers.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace pss::test {
namespace {

std::string text_of(double value) {
  std::string text;
  append_number(value, text);
  return text;
}

std::string decimal(double value, double tolerance) {
  std::string text;
  append_decimal(value, tolerance, text);
  return text;
}

TEST(Numbers, ReadBackAsTheSameDouble) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (std::isnan(value)) continue;
    double back = 0;

    ASSERT_EQ(parse_number(text_of(value), back), NumberFault::kNone) << text_of(value);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value));
  }
}

TEST(Numbers, ReadBackAsTheSameFloat) {
  std::mt19937 random(8);
  for (int i = 0; i < 20000; ++i) {
    const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isnan(value)) continue;
    std::string text;
    append_number(value, text);
    float back = 0;

    ASSERT_EQ(parse_number(text, Type::kFloat32, reinterpret_cast<std::byte*>(&back)),
              NumberFault::kNone)
        << text;
    EXPECT_EQ(std::bit_cast<std::uint32_t>(back), std::bit_cast<std::uint32_t>(value)) << text;
  }
}

TEST(Numbers, AreWrittenWithoutExponentWherePeopleWouldNot) {
  EXPECT_EQ(text_of(500000), "500000");
  EXPECT_EQ(text_of(-0.0378297), "-0.0378297");
  EXPECT_EQ(text_of(1e-7), "1e-07");
  EXPECT_EQ(text_of(1e300), "1e+300");
  EXPECT_EQ(text_of(0), "0");
}

TEST(Numbers, OfSixtyFourBitsAreWrittenExactly) {
  std::string text;
  const auto most = std::numeric_limits<std::uint64_t>::max();
  const auto least = std::numeric_limits<std::int64_t>::min();
  append_number(Type::kUint64, reinterpret_cast<const std::byte*>(&most), text);
  text += ' ';
  append_number(Type::kInt64, reinterpret_cast<const std::byte*>(&least), text);

  EXPECT_EQ(text, "18446744073709551615 -9223372036854775808");
}

TEST(Numbers, TellsTooLargeFromTooSmall) {
  double value = 1;
  EXPECT_EQ(parse_number("1e400", value), NumberFault::kOutOfRange);
  EXPECT_EQ(parse_number("-1e-400", value), NumberFault::kNone);
  EXPECT_EQ(value, 0);
  for (const std::string& tiny : {std::string("1e-99999999999999999999"), std::string("12e-9999"),
                                  "0." + std::string(6000, '0') + "1"}) {
    EXPECT_EQ(parse_number(tiny, value), NumberFault::kNone) << tiny;
    EXPECT_EQ(value, 0);
  }
  EXPECT_EQ(parse_number("-1e-99999", value), NumberFault::kNone);
  EXPECT_TRUE(std::signbit(value));
  for (const char* huge : {"0.1e99999999999999999999", "12e9223372036854775807"})
    EXPECT_EQ(parse_number(huge, value), NumberFault::kOutOfRange) << huge;
  EXPECT_EQ(parse_number(std::string(6000, '9') + "e-9", value), NumberFault::kOutOfRange);
  EXPECT_EQ(parse_number("1e", value), NumberFault::kNoNumber);
  EXPECT_EQ(parse_number("", value), NumberFault::kNoNumber);
}

TEST(Numbers, OnADecimalGridAreWrittenAsDecimals) {
  for (int i = -100000; i < 100000; i += 37) {
    const double origin = 637000.25;
    const double value = origin + 0.01 * i;
    const double tolerance = 0x1p-51 * (origin + value);
    const long hundredths = 63700025 + i;

    std::string expected =
        std::to_string(hundredths / 100) + "." + std::to_string(100 + hundredths % 100).substr(1);
    while (expected.back() == '0') expected.pop_back();
    if (expected.back() == '.') expected.pop_back();

    ASSERT_EQ(decimal(value, tolerance), expected);
  }
  EXPECT_EQ(decimal(0.1 * 3, 1e-16), "0.3");
  EXPECT_EQ(decimal(-0.05, 1e-16), "-0.05");
  EXPECT_EQ(decimal(-12, 0), "-12");
  EXPECT_EQ(decimal(0, 0), "0");
}

TEST(Numbers, OnNoDecimalGridStayExact) {
  EXPECT_EQ(decimal(1.0 / 3, 0), text_of(1.0 / 3));
  EXPECT_EQ(decimal(1e300, 0), "1e+300");
  EXPECT_EQ(decimal(std::numeric_limits<double>::infinity(), 0), "inf");
}

TEST(Numbers, AreQuotedWithoutUnprintableBytes) {
  EXPECT_EQ(in_quotes(std::string_view("a\0\xff", 3)), "'a?\?'");
  EXPECT_EQ(in_quotes(std::string(1000, 'a')), "'" + std::string(40, 'a') + "...'");
}

}  // namespace
}  // namespace pss::test
