#include "core/fixed_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/cloud.h"

namespace pss::test {
namespace {

TEST(FixedSums, HaveTheMeanAndTheSampleDeviationOfTheirTerms) {
  FixedSums sums;
  for (const std::uint32_t value : {2u, 4u, 4u, 4u, 5u, 5u, 7u, 9u}) sums.add(value);

  EXPECT_EQ(sums.count(), 8u);
  EXPECT_DOUBLE_EQ(sums.mean(), 5);
  EXPECT_DOUBLE_EQ(sums.deviation(), std::sqrt(32.0 / 7));
}

TEST(FixedSums, LoseNothingWhereTermsAreLargeAndAlike) {
  FixedSums sums;
  for (int i = 0; i < 1000; ++i) sums.add(i % 2 ? 0xfffffffeu : 0xffffffffu);

  EXPECT_DOUBLE_EQ(sums.mean(), 4294967294.5);
  EXPECT_DOUBLE_EQ(sums.deviation(), std::sqrt(250.0 / 999));
}

TEST(FixedSums, AreTheSameHoweverTermsAreGrouped) {
  Random random(3);
  FixedSums whole;
  std::vector<FixedSums> parts(7);
  for (int i = 0; i < 5000; ++i) {
    const auto value = static_cast<std::uint32_t>(random.next());
    whole.add(value);
    parts[random.next() % parts.size()].add(value);
  }

  FixedSums again;
  for (const FixedSums& part : parts) again.add(FixedSums::from_bytes(part.to_bytes()));

  EXPECT_EQ(again.to_bytes(), whole.to_bytes());
}

TEST(FixedSums, OfNothingAndOfOneTermHaveNoDeviation) {
  FixedSums sums;
  EXPECT_EQ(sums.mean(), 0);
  EXPECT_EQ(sums.deviation(), 0);
  sums.add(7);
  EXPECT_EQ(sums.mean(), 7);
  EXPECT_EQ(sums.deviation(), 0);
  EXPECT_EQ(FixedSums::from_bytes({}).count(), 0u);
}

}  // namespace
}  // namespace pss::test
