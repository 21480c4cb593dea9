#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <map>

#include "core/parallel.h"
#include "stream/sort/ingest.h"
#include "stream/sort/run.h"
#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_value;

/// The bytes of every file of a store, by name.
std::map<std::string, std::vector<std::byte>> files_of(const std::string& store) {
  std::map<std::string, std::vector<std::byte>> files;
  for (const auto& entry : std::filesystem::directory_iterator(store))
    files[entry.path().filename().string()] = test::bytes_of(entry.path().string());
  // Records of a manifest say how much was durable when they were written, which an interruption
  // changes; what they say otherwise is compared through the tiles.
  files["manifest"].clear();
  return files;
}

class Resume : public testing::Test {
 protected:
  Resume() {
    test::write_cloud(folder_ / "a.las", test::sheet(9000, 2));
    test::write_cloud(folder_ / "b.las", test::sheet(7000, 3));
    Monitor monitor;
    options_ = test::small_tiles(700);
    plan_ = expect_value(plan_ingest({folder_ / "a.las", folder_ / "b.las"}, options_, monitor));
  }

  Result<IngestSummary> ingest_until(const std::string& name, std::uint64_t stop_at,
                                     std::uint64_t total) {
    MemoryBudget budget = test::budget_of(total);
    test::StoppingMonitor monitor(stop_at);
    auto result = ingest(plan_, folder_ / (name + ".pss"), folder_ / (name + ".work"), options_,
                         budget, monitor);
    asked_ = monitor.asked();
    EXPECT_EQ(budget.available(), budget.total());
    return result;
  }

  void expect_same_store(const std::string& name) {
    const Store a = expect_value(Store::open(folder_ / "whole.pss"));
    const Store b = expect_value(Store::open(folder_ / (name + ".pss")));
    EXPECT_EQ(a.summary(), b.summary());
    ASSERT_EQ(a.tiles().size(), b.tiles().size());
    for (std::size_t t = 0; t < a.tiles().size(); ++t) {
      EXPECT_EQ(a.tiles()[t].cell, b.tiles()[t].cell);
      EXPECT_EQ(a.tiles()[t].index_hash, b.tiles()[t].index_hash);
      EXPECT_EQ(a.tiles()[t].offset, b.tiles()[t].offset);
    }
    EXPECT_EQ(files_of(folder_ / "whole.pss"), files_of(folder_ / (name + ".pss")));
  }

  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint64_t kRoomy = 64 << 20;
  static constexpr std::uint64_t kTight = 3800 << 10;

  ThreadLimit threads_{2};  // they decide how much memory is left for a chunk
  test::TemporaryDirectory folder_;
  IngestOptions options_;
  IngestPlan plan_;
  std::uint64_t asked_ = 0;
};

TEST_F(Resume, GivesTheSameStoreAfterAnInterruptAtAnyQuestion) {
  ASSERT_TRUE(ingest_until("whole", kNever, kRoomy).has_value());
  for (const std::uint64_t total : {kRoomy, kTight}) {
    ASSERT_TRUE(ingest_until("count", kNever, total).has_value());
    std::filesystem::remove_all(folder_ / "count.pss");
    const std::uint64_t questions = asked_;
    const std::uint64_t step = std::max<std::uint64_t>(1, questions / 14);
    for (std::uint64_t k = 1; k < questions; k += step) {
      const auto stopped = ingest_until("s", k, total);
      ASSERT_FALSE(stopped.has_value()) << k;
      ASSERT_EQ(stopped.error().fault, Fault::kInterrupted) << stopped.error().message;

      const auto done = ingest_until("s", kNever, k % 2 == 0 ? kRoomy : kTight);

      ASSERT_TRUE(done.has_value()) << done.error().message;
      EXPECT_EQ(done->points_stored, 16000u);
      expect_same_store("s");
      std::filesystem::remove_all(folder_ / "s.pss");
    }
  }
}

TEST_F(Resume, GoesOnThroughManyInterruptsOfOneIngest) {
  ASSERT_TRUE(ingest_until("whole", kNever, kRoomy).has_value());
  int interrupts = 0;
  // Enough questions for a run or a few tiles at a time.
  while (!ingest_until("s", 40, kTight).has_value()) ASSERT_LT(++interrupts, 200);
  EXPECT_GE(interrupts, 3);
  expect_same_store("s");
}

TEST_F(Resume, FinishesARunsLogThatIsTornAndRunsThatAreHalfWritten) {
  ASSERT_TRUE(ingest_until("whole", kNever, kRoomy).has_value());
  std::uint64_t k = 1;
  while (!exists(folder_ / "s.work/runs/run-000001")) {
    ASSERT_FALSE(ingest_until("s", k += 3, kTight).has_value());
  }
  const std::string log = folder_ / "s.work/runs/log";
  const auto bytes = test::bytes_of(log);
  test::write_bytes(log, std::span(bytes).first(bytes.size() - 1));
  test::write_bytes(folder_ / "s.work/runs/run-000001", std::span(bytes).first(10));

  ASSERT_TRUE(ingest_until("s", kNever, kTight).has_value());

  expect_same_store("s");
}

TEST_F(Resume, NamesADamagedRun) {
  std::uint64_t k = 1;
  const std::string run = folder_ / "s.work/runs/run-000000";
  while (!exists(folder_ / "s.work/runs/run-000002"))
    ASSERT_FALSE(ingest_until("s", k += 3, kTight).has_value());
  auto bytes = test::bytes_of(run);
  bytes[bytes.size() / 2] ^= std::byte{16};
  test::write_bytes(run, bytes);

  const auto result = ingest_until("s", kNever, kTight);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().fault, Fault::kBadInput);
  EXPECT_NE(result.error().message.find(run + ": damaged at offset"), std::string::npos)
      << result.error().message;
}

TEST_F(Resume, RefusesRunsOfOtherInputs) {
  std::uint64_t k = 1;
  while (!exists(folder_ / "s.work/runs/run-000001"))
    ASSERT_FALSE(ingest_until("s", k += 3, kTight).has_value());
  plan_.header.tile_points = 701;

  const auto result = ingest_until("s", kNever, kTight);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().fault, Fault::kFailed);
  EXPECT_NE(result.error().message.find("--restart"), std::string::npos);
}

}  // namespace
}  // namespace pss
