#include "io/points/position_survey.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

namespace pss::test {
namespace {

/// Positions in memory, read one by one.
class Positions : public Reader {
 public:
  explicit Positions(std::vector<World3> positions) : positions_(std::move(positions)) {}
  const CloudHeader& header() const override { return header_; }
  Result<void> read(std::size_t max, PointBatch& batch) override {
    batch.clear();
    batch.first_record = next_;
    if (next_ < positions_.size() && max > 0) batch.world = {positions_[next_++]};
    return {};
  }
  Result<void> seek(std::uint64_t record) override {
    next_ = static_cast<std::size_t>(record);
    return {};
  }

 private:
  CloudHeader header_;
  std::vector<World3> positions_;
  std::size_t next_ = 0;
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ReadPositions, MeasuresWhatIsFiniteAndKeptAndCountsAll) {
  Positions reader({{0, 0, 0}, {kNan, 1, 1}, {1, 2, 3}, {1, kInf, 1}, {9, 9, 9}, {-1, 0, 1}});
  Monitor monitor;
  std::vector<std::uint64_t> records;

  const auto extent = read_positions(reader, WorldBox{{-5, -5, -5}, {5, 5, 5}}, monitor,
                                     [&](std::uint64_t r, const World3&) { records.push_back(r); });

  ASSERT_TRUE(extent.has_value());
  EXPECT_EQ(extent->records, 6u);
  EXPECT_EQ(extent->bounds, (WorldBox{{-1, 0, 0}, {1, 2, 3}}));
  EXPECT_EQ(records, (std::vector<std::uint64_t>{0, 2, 5}));
}

TEST(ReadPositions, OfNothingHasNoBounds) {
  Positions reader({{kNan, 0, 0}});
  Monitor monitor;

  const auto extent = read_positions(reader, {}, monitor, [](std::uint64_t, const World3&) {});

  ASSERT_TRUE(extent.has_value());
  EXPECT_EQ(extent->records, 1u);
  EXPECT_TRUE(extent->bounds.empty());
}

}  // namespace
}  // namespace pss::test
