// Files that change while ingest() and smooth() read them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "io/convert.h"
#include "io/synth/synth.h"
#include "stream/jobs/smooth.h"
#include "tests/stream/ingest_fixture.h"
#include "tests/support/changes.h"

namespace pss {
namespace {

using test::ActingMonitor;
using test::Change;
using test::expect_value;

constexpr std::uint64_t kInMemory = 256 << 20;
constexpr std::uint64_t kInRuns = 3800 << 10;
constexpr std::uint64_t kWideInRuns = 11 << 20;  ///< PLY and text, with more bytes a point
constexpr std::size_t kPoints = 40000;

void expect_change(const Error& error, const std::string& file) {
  EXPECT_EQ(error.fault, Fault::kFailed) << error.message;
  for (const std::string& words : {file, std::string("changed while it was read")})
    EXPECT_NE(error.message.find(words), std::string::npos) << error.message;
}

/// A job that sorts scans of 40,000 points into a store.
class ChangedInputs : public ::testing::Test {
 protected:
  std::string scan(const std::string& name, std::uint64_t seed = 5) {
    test::write_cloud(folder_ / "cloud.las", test::sheet(kPoints, seed));
    Monitor monitor;
    expect_value(convert({folder_ / "cloud.las"}, folder_ / name, {.overwrite = true}, monitor));
    return folder_ / name;
  }

  Result<IngestSummary> sort(const std::vector<std::string>& inputs, Monitor& monitor,
                             std::uint64_t memory = kInMemory) {
    MemoryBudget budget = test::budget_of(memory);
    const IngestOptions options = test::small_tiles(1000);
    PSS_ASSIGN(const IngestPlan plan, plan_ingest(inputs, options, monitor));
    return ingest(plan, store_, folder_ / "work", options, budget, monitor);
  }

  void expect_refused(const std::vector<std::string>& inputs, const std::string& changed,
                      ActingMonitor& monitor, std::uint64_t memory = kInMemory) {
    const auto result = sort(inputs, monitor, memory);
    EXPECT_TRUE(monitor.acted());
    ASSERT_FALSE(result);
    expect_change(result.error(), changed);
    EXPECT_FALSE(exists(manifest_path(store_)));
    std::filesystem::remove_all(store_);
    std::filesystem::remove_all(folder_ / "work");
  }

  static void expect_ok(const Result<void>& result) { test::expect_ok(result); }

  test::TemporaryDirectory folder_;
  std::string store_ = folder_ / "s.pss";
};

TEST_F(ChangedInputs, AreRefusedWhateverTheFormatTheChangeAndTheMemory) {
  for (const char* name : {"a.las", "a.ply", "a.xyz"})
    for (const Change change : test::kChanges)
      for (const bool in_runs : {false, true}) {
        SCOPED_TRACE(
            fmt::format("{} {}{}", name, test::name_of(change), in_runs ? " in runs" : ""));
        const std::string input = scan(name);
        const std::uint64_t runs = input.ends_with("las") ? kInRuns : kWideInRuns;
        ActingMonitor monitor("read", in_runs ? kPoints / 3 : 0,
                              [&] { test::make_change(change, input); });

        expect_refused({input}, input, monitor, in_runs ? runs : kInMemory);
      }
}

TEST_F(ChangedInputs, AreRefusedWhereTheyChangeWhileTheirBoundsAreMeasured) {
  for (const char* name : {"a.ply", "a.xyz"})
    for (const Change change : test::kChanges) {
      SCOPED_TRACE(fmt::format("{} {}", name, test::name_of(change)));
      const std::string input = scan(name);
      ActingMonitor monitor("bounds", kPoints / 3, [&] { test::make_change(change, input); });

      expect_refused({input}, input, monitor);
    }
}

TEST_F(ChangedInputs, AreRefusedWhereAnotherInputIsReadOrTheTilesAreMerged) {
  for (const auto& [stage, points] : {std::pair{"read", kPoints + 1}, {"merge", std::size_t{0}}}) {
    SCOPED_TRACE(stage);
    const std::vector<std::string> inputs{scan("a.las"), scan("b.las", 6)};
    ActingMonitor monitor(stage, points,
                          [&] { test::make_change(Change::kOverwritten, inputs[0]); });

    expect_refused(inputs, inputs[0], monitor, kInRuns);
  }
}

TEST_F(ChangedInputs, LeaveNoRecordBehindForAFileThatIsSetBack) {
  const std::string input = scan("a.las");
  Monitor watching_nothing;
  expect_value(sort({input}, watching_nothing));
  MemoryBudget budget = test::budget_of(kInMemory);
  const auto expected = expect_value(verify_store(store_, budget, watching_nothing));
  std::filesystem::remove_all(store_);
  // As a backup is: the same bytes, and the same time.
  std::filesystem::copy_file(input, folder_ / "backup");
  std::filesystem::last_write_time(folder_ / "backup", std::filesystem::last_write_time(input));
  ActingMonitor monitor("read", kPoints / 3,
                        [&] { test::make_change(Change::kOverwritten, input); });
  EXPECT_FALSE(sort({input}, monitor, kInRuns));

  std::filesystem::rename(folder_ / "backup", input);
  expect_value(sort({input}, watching_nothing, kInRuns));

  const auto found = expect_value(verify_store(store_, budget, watching_nothing));
  EXPECT_EQ(found.rows, expected.rows);
}

TEST_F(ChangedInputs, AreToldFromDamageWhereAStoreIsCopiedOverAnother) {
  Monitor monitor;
  expect_value(sort({scan("a.las")}, monitor));
  std::filesystem::rename(store_, folder_ / "other.pss");
  expect_value(sort({scan("a.las", 6)}, monitor));
  const Store store = expect_value(Store::open(store_));

  for (const auto& file : std::filesystem::directory_iterator(folder_ / "other.pss"))
    std::filesystem::copy_file(file, store_ + "/" + file.path().filename().string(),
                               std::filesystem::copy_options::overwrite_existing);
  const auto rows = test::read_all(store);

  ASSERT_FALSE(rows);
  expect_change(rows.error(), manifest_path(store_));
}

/// Acts when it is first asked whether to stop: between a job's record and its plan.
class EarlyMonitor : public Monitor {
 public:
  explicit EarlyMonitor(std::function<void()> act) : act_(std::move(act)) {}
  bool stopping() const override {
    if (!std::exchange(acted_, true)) act_();
    return false;
  }

 private:
  std::function<void()> act_;
  mutable bool acted_ = false;
};

TEST_F(ChangedInputs, AreRefusedWhereTheyChangeBetweenAJobsRecordAndItsPlan) {
  SmoothJob job;
  job.inputs = {scan("a.las")};
  job.output = folder_ / "out.las";
  job.options.widths.h = 1;
  MemoryBudget budget = test::budget_of(kInMemory);
  EarlyMonitor monitor([&] { test::make_change(Change::kOverwritten, job.inputs[0]); });

  const auto result = smooth(job, budget, monitor);

  ASSERT_FALSE(result);
  expect_change(result.error(), job.inputs[0]);
  EXPECT_FALSE(exists(job.output));
}

}  // namespace
}  // namespace pss
