#include "apps/options.h"

#include <gtest/gtest.h>

#include <string>

#include "core/parallel.h"
#include "stream/limit/memory.h"

namespace pss::test {

TEST(Options, SizesArePowersOf1024) {
  EXPECT_EQ(*parse_size("512M"), 536870912u);
  EXPECT_EQ(*parse_size("4G"), 4294967296u);
  EXPECT_EQ(*parse_size("1.5k"), 1536u);
  EXPECT_EQ(*parse_size("100000000"), 100000000u);
}

TEST(Options, APercentageIsOfTheMachinesMemory) {
  EXPECT_EQ(*parse_size("100%"), machine_memory());
  EXPECT_NEAR(static_cast<double>(*parse_size("25%")), static_cast<double>(machine_memory()) / 4,
              1.0);
}

TEST(Options, CountsArePowersOf1000) {
  EXPECT_EQ(*parse_count("10k"), 10000u);
  EXPECT_EQ(*parse_count("2M"), 2000000u);
  EXPECT_EQ(*parse_count("1e9"), 1000000000u);
  EXPECT_EQ(*parse_count("1.5M"), 1500000u);
}

TEST(Options, CountsAbove2To53StayExact) {
  EXPECT_EQ(*parse_count("18446744073709551615"), 18446744073709551615u);
  EXPECT_EQ(*parse_count("9007199254740993"), 9007199254740993u);
}

TEST(Options, ATripleIsThreeNumbers) {
  EXPECT_EQ(*parse_triple("1,-2.5,3e6"), (World3{1, -2.5, 3e6}));
}

class RefusedSize : public testing::TestWithParam<const char*> {};
TEST_P(RefusedSize, IsAUsageErrorThatNamesWhatWasFound) {
  const Result<std::uint64_t> size = parse_size(GetParam());
  ASSERT_FALSE(size);
  EXPECT_EQ(size.error().fault, Fault::kUsage);
  EXPECT_NE(size.error().message.find(GetParam()), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(Options, RefusedSize,
                         testing::Values("", "M", "0", "-1G", "5X", "5GB", "101%", "nan", "inf",
                                         "1e300G", "0x10"));

class RefusedCount : public testing::TestWithParam<const char*> {};
TEST_P(RefusedCount, IsAUsageError) {
  ASSERT_FALSE(parse_count(GetParam()));
  EXPECT_EQ(parse_count(GetParam()).error().fault, Fault::kUsage);
}
INSTANTIATE_TEST_SUITE_P(Options, RefusedCount,
                         testing::Values("", "1.5", "-3", "2MM", "1e30", "nan",
                                         "18446744073709551616"));

TEST(Options, NumbersRefuseWhatFollowsThem) {
  EXPECT_FALSE(parse_number("1.0m"));
  EXPECT_FALSE(parse_number("1,0"));
  EXPECT_FALSE(parse_positive("0"));
  EXPECT_FALSE(parse_integer("-1"));
  EXPECT_FALSE(parse_integer("2147483648"));
  EXPECT_FALSE(parse_triple("1,2"));
  EXPECT_FALSE(parse_triple("1,2,3,"));
}

TEST(Options, ABoxIsItsLeastEndsAndThenItsGreatest) {
  EXPECT_EQ(*parse_box("-1,0,2.5,1e3,0,3"), (WorldBox{{-1, 0, 2.5}, {1000, 0, 3}}));
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,3,4,5,6,7", "0,0,0,1,1,-1", "a,2,3,4,5,6",
                           "0,0,0,1,1,nan"}) {
    const Result<WorldBox> box = parse_box(text);
    ASSERT_FALSE(box) << text;
    EXPECT_EQ(box.error().fault, Fault::kUsage);
  }
}

TEST(Options, ThreadsAreNotManyMoreThanTheMachineRuns) {
  EXPECT_EQ(*parse_threads("0"), 0);
  EXPECT_EQ(*parse_threads(std::to_string(2 * thread_count())), 2 * thread_count());
  const Result<int> threads = parse_threads("100000");
  ASSERT_FALSE(threads);
  EXPECT_EQ(threads.error().fault, Fault::kUsage);
  const std::string machine = "this machine runs " + std::to_string(thread_count());
  EXPECT_NE(threads.error().message.find(machine), std::string::npos) << threads.error().message;
}

TEST(Options, ALimitBelowTheProgramsOwnNeedIsRefusedWithTheOneThatWouldDo) {
  LimitOptions options;
  options.threads = 2;
  options.memory_limit = 1 << 20;
  const Result<std::uint64_t> limit = options.limit();
  ASSERT_FALSE(limit);
  EXPECT_EQ(limit.error().fault, Fault::kMemoryLimit);
  EXPECT_NE(limit.error().message.find(std::to_string(minimum_limit(2))), std::string::npos);
}

}  // namespace pss::test
