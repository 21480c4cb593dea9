// Jobs of other kinds than smooth, on a disk that crashes: one whose passes are known only as they
// come, and one without a pass.

#include "stream/jobs/run_job.h"

#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "stream/jobs/job_state.h"
#include "stream/jobs/tile.h"
#include "stream/jobs/work_directory.h"
#include "stream/operators/project.h"
#include "tests/faults/small_job.h"
#include "tests/stream/store_fixture.h"

namespace pss::test {
namespace {

constexpr double kSettled = 0.02;

JobRequest request_to(const std::string& output) {
  JobRequest request;
  request.inputs = {kScan};
  request.output = output;
  request.tile_points = 200;
  request.state_folder = "/state/pss";
  return request;
}

/// Projects again and again, until the points of a round hardly move.
class Rounds : public JobKind {
 public:
  std::string_view command() const override { return "rounds"; }
  nlohmann::json parameters() const override { return {{"settled", kSettled}}; }
  PassNames passes() const override { return {{"round-1"}, true}; }
  Result<void> check() const override { return {}; }

  Result<std::optional<Pass>> next(PassContext& job) override {
    if (!job.done.empty()) moves.push_back(rms_of(job.done.back()));
    if (!job.done.empty() && moves.back() < kSettled) return std::optional<Pass>();
    const std::size_t round = job.done.size() + 1;
    PSS_ASSIGN(std::unique_ptr<PassSource> source,
               job.done.empty() ? job.open_input() : job.open_result(job.done.back().name));
    ProjectParameters parameters;
    parameters.support = {1.0, 3.0};
    parameters.record = owned_by(job.identity, {{"round", round}});
    PSS_ASSIGN(ProjectOperator op, ProjectOperator::create(source->points(), parameters));
    return std::optional(Pass{.name = fmt::format("round-{}", round),
                              .queries = std::move(source),
                              .op = std::make_unique<ProjectOperator>(std::move(op)),
                              .largest_move = 3.0});
  }

  std::vector<double> moves;  ///< of the rounds that this run has looked at

 private:
  static double rms_of(const DonePass& pass) {
    return ProjectStatistics::from_bytes(pass.note.bytes).rms_displacement();
  }
};

Result<JobReport> run_rounds(Monitor& monitor, JobRequest request = request_to(kOut)) {
  Rounds rounds;
  MemoryBudget budget(std::uint64_t{256} << 20, 1);
  return run_job(request, rounds, budget, monitor);
}

Result<JobReport> run_tile() {
  TileJob job;
  static_cast<JobRequest&>(job) = request_to("/out.pss");
  Monitor monitor;
  MemoryBudget budget(std::uint64_t{256} << 20, 1);
  return tile(job, budget, monitor);
}

/// A job that is cut before any of its changes ends with the same bytes when it is run again.
void expect_survives_crashes(const std::function<Result<JobReport>()>& run,
                             const std::vector<std::string>& results) {
  std::vector<std::vector<std::byte>> whole;
  std::uint64_t changes = 0;
  {
    SimulatedDisk disk;
    disk.put(kScan, wavy_sheet(kSheet));
    expect_value(run());
    for (const std::string& path : results) whole.push_back(disk.content(path));
    changes = disk.changes_made();
  }
  for (const Crash crash : {Crash::kKeep, Crash::kForget, Crash::kTear, Crash::kGarble})
    for (std::uint64_t n = 1 + static_cast<std::uint64_t>(crash); n <= changes; n += stride(13)) {
      SCOPED_TRACE(fmt::format("crash {} before change {}", static_cast<int>(crash), n));
      SimulatedDisk disk;
      disk.put(kScan, wavy_sheet(kSheet));
      disk.crash_before(n);
      static_cast<void>(run());
      disk.restart(crash, n);

      const auto again = run();

      ASSERT_TRUE(again) << again.error().message;
      for (std::size_t i = 0; i < results.size(); ++i)
        ASSERT_TRUE(disk.content(results[i]) == whole[i]) << "other bytes: " << results[i];
    }
}

TEST(RunJob, MakesPassesUntilWhatTheyNotedSaysThatAllIsDone) {
  SimulatedDisk disk;
  disk.put(kScan, wavy_sheet(kSheet));
  Rounds rounds;
  Monitor monitor;
  MemoryBudget budget(std::uint64_t{256} << 20, 1);

  const JobReport report = expect_value(run_job(request_to(kOut), rounds, budget, monitor));

  ASSERT_GE(rounds.moves.size(), 2u) << "a job of one round shows little";
  EXPECT_LT(rounds.moves.back(), kSettled);
  EXPECT_GE(rounds.moves[rounds.moves.size() - 2], kSettled);
  std::vector<std::string> stages{"plan", "sort"}, seen;
  for (std::size_t i = 1; i <= rounds.moves.size(); ++i)
    stages.push_back(fmt::format("round-{}", i));
  stages.emplace_back("write");
  for (const StageReport& stage : report.stages) seen.push_back(stage.name);
  EXPECT_EQ(seen, stages);
  for (const std::string& file : disk.files())
    EXPECT_FALSE(file.starts_with(kOut + ".work")) << file;
}

TEST(RunJob, WhosePassesAreKnownAsTheyComeGoesOnAfterACrash) {
  Monitor monitor;
  expect_survives_crashes([&] { return run_rounds(monitor); }, {kOut});
}

TEST(RunJob, WithoutAPassGoesOnAfterACrash) {
  expect_survives_crashes(run_tile, {"/out.pss/segment-000000"});  // its manifest has times
}

/// Stops when a stage begins, and looks at the work directory then.
class StopAt : public Monitor {
 public:
  explicit StopAt(std::string stage) : stage_(std::move(stage)) {}
  void begin(std::string_view stage, std::uint64_t, std::uint64_t) override {
    if (stage == stage_) stopped_ = true;
  }
  bool stopping() const override { return stopped_; }

 private:
  std::string stage_;
  bool stopped_ = false;
};

TEST(RunJob, NamesAPassInItsRecordBeforeItsStoreIsMade) {
  SimulatedDisk disk;
  disk.put(kScan, wavy_sheet(kSheet));
  StopAt monitor("round-2");

  const auto stopped = run_rounds(monitor);

  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().fault, Fault::kInterrupted);
  const auto record = expect_value(read_job_record(kOut + ".work"));
  ASSERT_TRUE(record);
  EXPECT_EQ(record->passes, (std::vector<std::string>{"round-1", "round-2"}));
  EXPECT_TRUE(record->may_grow);
  EXPECT_EQ(expect_value(read_job_state(kOut + ".work")).stage, "round-2");
}

TEST(RunJob, OfARestartRemovesTheStoresOfAllPassesThatTheRecordNames) {
  SimulatedDisk disk;
  disk.put(kScan, wavy_sheet(kSheet));
  StopAt second("round-2"), first("round-1");
  ASSERT_FALSE(run_rounds(second));
  ASSERT_TRUE(exists(kOut + ".work/round-2.pss"));
  JobRequest request = request_to(kOut);
  request.restart = true;

  ASSERT_FALSE(run_rounds(first, request));

  EXPECT_FALSE(exists(kOut + ".work/round-2.pss"));
  EXPECT_EQ(expect_value(read_job_record(kOut + ".work"))->passes,
            std::vector<std::string>{"round-1"});
}

}  // namespace
}  // namespace pss::test
