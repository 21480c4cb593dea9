// Inputs whose records are decoded together by the ten thousands, as in a LAZ chunk.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "core/parallel.h"
#include "stream/sort/disk_need.h"
#include "stream/sort/ingest_memory.h"
#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::budget_of;
using test::Cloud;
using test::expect_value;
using test::las_grid;
using test::las_schema;

constexpr std::size_t kUnit = 50000;

/// Record number `i` of every scan here.
Index3 position_of(std::uint64_t i) {
  const std::uint64_t bits = (i + 1) * 0x9E3779B97F4A7C15u;
  return {static_cast<std::int64_t>(bits >> 50), static_cast<std::int64_t>((bits >> 30) % 9000), 7};
}
std::byte intensity_of(std::uint64_t i) { return static_cast<std::byte>(i % 251); }

/// What readers of a scan were asked for.
struct Asked {
  std::mutex mutex;
  std::map<std::uint64_t, int> decoded;  ///< how often, by the number of the unit
  std::set<const RawPoints*> batches;    ///< that were filled
  std::atomic<int> decoding = 0;         ///< calls of decode() at this moment
  std::atomic<int> most_decoding = 0;
  bool wait_for_another = false;  ///< decode() gives another thread time to come

  std::uint64_t decoded_units() const {
    std::uint64_t sum = 0;
    for (const auto& [unit, times] : decoded) sum += static_cast<std::uint64_t>(times);
    return sum;
  }
};

class UnitReader : public Reader {
 public:
  UnitReader(std::uint64_t count, std::size_t unit, Asked& asked) : unit_(unit), asked_(asked) {
    header_.path = "units";
    header_.format = "LAS";
    header_.count = count;
    header_.grid = las_grid();
    header_.bounds = WorldBox{las_grid().origin, to_world(las_grid(), {16383, 8999, 7})};
    header_.schema = las_schema();
  }

  const CloudHeader& header() const override { return header_; }
  std::size_t unit() const override { return unit_; }

  Result<void> read(std::size_t max, PointBatch& batch) override {
    RawPoints raw;
    PSS_TRY(fetch(max, raw));
    decode(raw);
    batch = std::move(raw.points);
    return {};
  }

  Result<void> fetch(std::size_t max, RawPoints& out) override {
    const std::uint64_t whole = (next_ + max) / unit_ * unit_;
    const std::uint64_t end = std::min(whole > next_ ? whole : next_ + max, *header_.count);
    const std::lock_guard lock(asked_.mutex);
    for (std::uint64_t unit = next_ / unit_; next_ < end && unit * unit_ < end; ++unit)
      ++asked_.decoded[unit];
    asked_.batches.insert(&out);
    out.points.first_record = next_;
    out.count = static_cast<std::size_t>(end - next_);
    next_ = end;
    return {};
  }

  void decode(RawPoints& raw) const override {
    const int now = ++asked_.decoding;
    int most = asked_.most_decoding;
    while (most < now && !asked_.most_decoding.compare_exchange_weak(most, now)) {
    }
    for (int i = 0; asked_.wait_for_another && asked_.most_decoding < 2 && i < 2000; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::size_t row = header_.schema.row_size();
    raw.points.index.resize(raw.count);
    raw.points.rows.assign(raw.count * row, std::byte{0});
    for (std::size_t i = 0; i < raw.count; ++i) {
      raw.points.index[i] = position_of(raw.points.first_record + i);
      raw.points.rows[i * row] = intensity_of(raw.points.first_record + i);
    }
    --asked_.decoding;
  }

  Result<void> seek(std::uint64_t record) override {
    next_ = record;
    return {};
  }

 private:
  CloudHeader header_;
  std::size_t unit_;
  Asked& asked_;
  std::uint64_t next_ = 0;
};

/// A scan of so many points as an input; its file stands for it.
class Units : public ::testing::Test {
 protected:
  Units() { test::write_text(folder_ / "scan", "stands for the scan"); }

  Result<IngestPlan> plan(std::uint64_t points, std::size_t unit = kUnit) {
    options_.tile_points = 5000;
    options_.open = [this, points, unit](const InputRecord&, HeadBytes,
                                         std::optional<std::uint64_t>) {
      return Result<std::unique_ptr<Reader>>(std::make_unique<UnitReader>(points, unit, asked_));
    };
    return plan_ingest({folder_ / "scan"}, options_, monitor_);
  }

  Result<IngestSummary> run(const IngestPlan& plan, MemoryBudget budget) {
    return ingest(plan, folder_ / "s.pss", folder_ / "work", options_, budget, monitor_);
  }

  Cloud stored() const {
    return expect_value(test::read_all(expect_value(Store::open(folder_ / "s.pss"))));
  }

  test::TemporaryDirectory folder_;
  IngestOptions options_;
  Monitor monitor_;
  Asked asked_;
};

/// The same scan in memory, in the order of a store.
Cloud expected(std::uint64_t points) {
  const std::size_t row = las_schema().row_size();
  Cloud cloud;
  cloud.rows.resize(points * row);
  for (std::uint64_t i = 0; i < points; ++i) {
    cloud.positions.push_back(position_of(i));
    cloud.rows[i * row] = intensity_of(i);
  }
  return test::sorted(cloud);
}

/// The limit that leaves the least that will do, in bytes for data.
std::uint64_t least(const IngestPlan& plan) {
  return least_ingest_memory(plan.header, plan.points, plan.unit);
}

TEST_F(Units, AreDecodedOnceEachInMemoryAndInManyRuns) {
  constexpr std::uint64_t kPoints = 4 * kUnit + 12345;
  const IngestPlan plan = expect_value(this->plan(kPoints));
  EXPECT_EQ(plan.unit, kUnit);
  for (const std::uint64_t total : {std::uint64_t{256} << 20, least(plan)}) {
    asked_.decoded.clear();

    const auto summary = expect_value(run(plan, budget_of(total)));

    EXPECT_EQ(summary.points_stored, kPoints);
    EXPECT_EQ(asked_.decoded.size(), 5u);
    EXPECT_EQ(asked_.decoded_units(), 5u) << total;
    const Cloud cloud = stored();
    const Cloud wanted = expected(kPoints);
    EXPECT_EQ(cloud.positions, wanted.positions);
    EXPECT_EQ(cloud.rows, wanted.rows);
    std::filesystem::remove_all(folder_ / "s.pss");
    std::filesystem::remove_all(folder_ / "work");
  }
}

TEST_F(Units, AreDecodedByAllThreads) {
  // On one processor oneTBB runs one thread, whatever the limit.
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "needs two processors";
  ThreadLimit threads(2);
  const IngestPlan plan = expect_value(this->plan(4 * kUnit));
  asked_.wait_for_another = true;

  expect_value(run(plan, budget_of(std::uint64_t{256} << 20)));

  EXPECT_GE(asked_.most_decoding, 2);
}

TEST_F(Units, AreHeldNoMoreThanTheirShareOfTheLimitAllows) {
  const IngestPlan plan = expect_value(this->plan(6 * kUnit));
  for (const std::uint64_t more : {0, 30 << 20}) {
    const std::uint64_t total = least(plan) + more;
    const auto memory =
        expect_value(divide_memory(plan.header, plan.points, plan.unit, budget_of(total)));
    asked_.batches.clear();

    expect_value(run(plan, budget_of(total)));

    EXPECT_EQ(memory.batches.points % kUnit, 0u);
    EXPECT_LE(asked_.batches.size(), memory.batches.count);
    EXPECT_LE(input_memory(plan.header.schema, memory.batches), memory.read_bytes);
    EXPECT_LE(memory.read_bytes, total);
    std::filesystem::remove_all(folder_ / "s.pss");
    std::filesystem::remove_all(folder_ / "work");
  }
}

TEST_F(Units, ThatDoNotFitAreRefusedWithTheLimitThatDoes) {
  const IngestPlan plan = expect_value(this->plan(8000000, 4000000));

  const auto refused = run(plan, budget_of(least(plan) - 1));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::kMemoryLimit);
  EXPECT_NE(refused.error().message.find("4000000 records"), std::string::npos)
      << refused.error().message;
  const std::string before = "--memory-limit ";
  const std::size_t at = refused.error().message.find(before);
  ASSERT_NE(at, std::string::npos) << refused.error().message;
  const MemoryBudget named(std::stoull(refused.error().message.substr(at + before.size())) << 20,
                           1);
  EXPECT_TRUE(divide_memory(plan.header, plan.points, plan.unit, named).has_value());
}

TEST_F(Units, BeyondAnyChunkAreRefusedByName) {
  const auto refused = plan(std::uint64_t{1} << 32, kLargestUnit + 1);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::kBadInput);
  EXPECT_NE(refused.error().message.find("units"), std::string::npos);
}

TEST_F(Units, ThatASampleTakesPointsOfAreFew) {
  constexpr std::uint64_t kPoints = 400 * kUnit;
  const IngestPlan plan = expect_value(this->plan(kPoints));

  const double bytes = expect_value(sample_bytes(plan, false, kPoints, monitor_));

  EXPECT_GT(bytes, 1);
  EXPECT_LT(asked_.decoded_units(), 120u);
}

}  // namespace
}  // namespace pss
