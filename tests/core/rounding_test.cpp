// Floating-point values are rounded where the code says so, at every optimisation level.

#include <gtest/gtest.h>

namespace pss {
namespace {

struct Pair {
  double values[2];
};

[[gnu::noipa]] Pair through_float(const Pair& pair) {
  return {{static_cast<double>(static_cast<float>(pair.values[0])),
           static_cast<double>(static_cast<float>(pair.values[1]))}};
}

/// g++ 12 drops both roundings where it makes one vector of the pair.
TEST(Rounding, OfAPairToFloatIsNotOptimisedAway) {
  const Pair tenths = {{0.1, 0.3}};

  const Pair rounded = through_float(tenths);

  EXPECT_EQ(rounded.values[0], 0x1.99999ap-4);
  EXPECT_EQ(rounded.values[1], 0x1.333334p-2);
}

}  // namespace
}  // namespace pss
