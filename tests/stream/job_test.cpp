#include "stream/job.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <optional>

#include "io/fingerprint.h"
#include "stream/smooth_json.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

JobRecord some_record() {
  JobRecord record;
  record.command = "smooth";
  record.output = "out put.las";
  record.parameters = R"({"radius":1.5,"knn":null})";
  record.inputs = {{"a.las", 10, 20, 30}, {"b.las", 11, 21, 31}};
  return record;
}

TEST(WorkDirectory, KeepsItsRecord) {
  test::TemporaryDirectory folder;
  JobRecord record = some_record();
  record.complete = true;
  record.result = InputRecord{"out put.las", 1, -2, 18446744073709551615u};
  {
    const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));
    EXPECT_FALSE(expect_value(work.read_record()).has_value());
    expect_ok(work.write_record(record));
  }

  const JobRecord found = *expect_value(read_job_record(folder / "w"));

  EXPECT_EQ(found.inputs, record.inputs);
  EXPECT_EQ(found.result, record.result);
  EXPECT_TRUE(found.complete);
  EXPECT_TRUE(check_same_job(found, record, "w"));
}

TEST(WorkDirectory, RefusesASecondProcessByPidAndHost) {
  test::TemporaryDirectory folder;
  const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));

  const auto second = WorkDirectory::open(folder / "w");

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().fault, Fault::kFailed);
  EXPECT_NE(second.error().message.find(std::to_string(getpid())), std::string::npos);
  EXPECT_EQ(job_holder(folder / "w").value_or("").find("process "), 0u);
}

TEST(WorkDirectory, TakesOverTheLockOfADeadProcess) {
  test::TemporaryDirectory folder;
  const pid_t child = fork();
  if (child == 0) {
    const auto work = WorkDirectory::open(folder / "w");
    _exit(work ? 0 : 1);  // without the destructor, as a killed process
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);

  EXPECT_TRUE(WorkDirectory::open(folder / "w"));
}

TEST(WorkDirectory, ClearsOnlyWhatAJobKeepsThere) {
  test::TemporaryDirectory folder;
  const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));
  expect_ok(work.write_record(some_record()));
  expect_ok(make_directories(work.input_store()));
  std::ofstream(folder / "w/thesis.txt") << "keep me";

  expect_ok(work.clear());

  EXPECT_FALSE(exists(work.input_store()));
  EXPECT_FALSE(exists(folder / "w/job.json"));
  EXPECT_TRUE(exists(folder / "w/thesis.txt"));
}

TEST(WorkDirectory, NamesADamagedRecord) {
  test::TemporaryDirectory folder;
  const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));
  std::ofstream(folder / "w/job.json") << "{\"command\": 3";

  const auto record = work.read_record();

  ASSERT_FALSE(record);
  EXPECT_NE(record.error().message.find("job.json"), std::string::npos);
}

TEST(WorkDirectory, RefusesARecordNestedWithoutEnd) {
  test::TemporaryDirectory folder;
  const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));
  const std::string open(1000000, '['), close(1000000, ']');
  std::ofstream(folder / "w/job.json") << R"({"checksum":"","parameters":)" << open << close << "}";

  EXPECT_FALSE(work.read_record());
}

TEST(ResultSummary, OfOtherTypesIsNotTaken) {
  SmoothReport report;

  read_result_summary(R"({"store_bytes":7,"notes":3,"widths":{"h":"wide"}})", report);
  read_result_summary(R"({"store_bytes":7})", report);

  EXPECT_EQ(report.store_bytes, 7u);
}

TEST(WorkDirectory, OfADamagedRecordIsStartedOverOnRequestOnly) {
  test::TemporaryDirectory folder;
  const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));
  std::ofstream(folder / "w/job.json") << "{\"command\": 3";
  JobPlaces places{{}, folder / "b.las", folder / "w"};
  JobRecord record = some_record();

  const auto refused = enter_job(places, work, record);
  places.restart = true;
  const auto entered = enter_job(places, work, record);

  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("--restart"), std::string::npos);
  EXPECT_EQ(expect_value(entered), Entry::kNew);
  EXPECT_TRUE(expect_value(work.read_record()));
}

TEST(Places, OfAJobMustNotEndangerEachOther) {
  test::TemporaryDirectory folder;
  std::ofstream(folder / "a.las") << "points";
  const std::string work = folder / "w";

  EXPECT_TRUE(check_places({{folder / "a.las"}, folder / "b.las", work}));
  EXPECT_FALSE(check_places({{work + "/a.las"}, folder / "b.las", work}));
  EXPECT_FALSE(check_places({{folder / "a.las"}, work + "/../w/b.las", work}));
  EXPECT_FALSE(check_places({{folder / "a.las"}, folder / "b.las", folder.path().string()}));
  EXPECT_TRUE(exists(folder / "a.las"));
}

TEST(Places, OfAStoreLieOnOneDisk) {
  test::TemporaryDirectory folder;
  ASSERT_FALSE(same_disk(folder.path().string(), "/proc"));  // where no file is kept

  EXPECT_TRUE(check_places({{}, folder / "s.pss", folder / "w"}));
  EXPECT_FALSE(check_places({{}, folder / "s.pss", "/proc/w"}));
  EXPECT_TRUE(check_places({{}, folder / "s.las", "/proc/w"}));
}

class JobStages : public ::testing::Test {
 protected:
  JobStages() {
    places_.output = folder_ / "out.las";
    places_.work_dir = folder_ / "w";
  }
  Result<Entry> enter() {
    JobRecord record = some_record();
    return enter_job(places_, *work_, record);
  }

  test::TemporaryDirectory folder_;
  JobPlaces places_;
  std::optional<WorkDirectory> work_ = expect_value(WorkDirectory::open(folder_ / "w"));
};

TEST_F(JobStages, GoFromNewOverResumedToComplete) {
  EXPECT_EQ(expect_value(enter()), Entry::kNew);
  EXPECT_EQ(expect_value(enter()), Entry::kResumed);
  std::ofstream(places_.output) << "result";
  JobRecord record = some_record();
  expect_ok(leave_job(places_, *work_, record));

  EXPECT_EQ(expect_value(enter()), Entry::kComplete);
}

TEST_F(JobStages, KnowTheirOutputWhenStoppedJustAfterTheRename) {
  ASSERT_EQ(expect_value(enter()), Entry::kNew);
  std::ofstream(folder_ / "out.las.part") << "result";
  JobRecord record = some_record();
  expect_ok(record_result(*work_, record, folder_ / "out.las.part"));
  expect_ok(rename_file(folder_ / "out.las.part", places_.output));

  EXPECT_EQ(expect_value(enter()), Entry::kComplete);
}

TEST_F(JobStages, LeaveAFileAloneThatCameWhileTheyWorked) {
  ASSERT_EQ(expect_value(enter()), Entry::kNew);
  std::ofstream(places_.output) << "somebody's";

  EXPECT_FALSE(enter());
  places_.overwrite = true;
  EXPECT_EQ(expect_value(enter()), Entry::kResumed);
}

TEST_F(JobStages, BeginAgainWhenTheOutputIsGoneAndOnRestart) {
  ASSERT_EQ(expect_value(enter()), Entry::kNew);
  std::ofstream(places_.output) << "result";
  JobRecord record = some_record();
  expect_ok(leave_job(places_, *work_, record));

  places_.restart = true;
  EXPECT_FALSE(enter()) << "the output is there";
  places_.restart = false;
  EXPECT_EQ(expect_value(enter()), Entry::kComplete) << "and the record with it";
  expect_ok(remove_all(places_.output));
  EXPECT_EQ(expect_value(enter()), Entry::kNew);
}

TEST(SameJob, NamesTheFirstDifference) {
  const JobRecord then = some_record();
  const auto difference = [&](auto change) {
    JobRecord now = then;
    change(now);
    const Result<void> same = check_same_job(then, now, "w");
    return same ? std::string() : same.error().message;
  };

  const std::string radius =
      difference([](JobRecord& r) { r.parameters = R"({"radius":2,"knn":null})"; });
  const std::string input = difference([](JobRecord& r) { r.inputs[1].size = 12; });
  const std::string count = difference([](JobRecord& r) { r.inputs.pop_back(); });

  EXPECT_NE(radius.find("--radius was 1.5, is 2 now"), std::string::npos);
  EXPECT_NE(input.find("b.las has changed"), std::string::npos);
  EXPECT_NE(count.find("2 input files before, 1 now"), std::string::npos);
  EXPECT_EQ(difference([](JobRecord&) {}), "");
}

TEST(Fingerprint, SeesEveryEndOfAFile) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "f";
  std::vector<std::byte> bytes(200000, std::byte{1});
  test::write_bytes(path, bytes);
  const InputRecord before = expect_value(fingerprint(path));

  bytes.front() = std::byte{2};
  test::write_bytes(path, bytes);
  const InputRecord head = expect_value(fingerprint(path));
  bytes.front() = std::byte{1};
  bytes.back() = std::byte{2};
  test::write_bytes(path, bytes);
  const InputRecord tail = expect_value(fingerprint(path));

  EXPECT_EQ(before.size, 200000u);
  EXPECT_NE(head.content_hash, before.content_hash);
  EXPECT_NE(tail.content_hash, before.content_hash);
}

TEST(Job, CountsTheNamesOfItsInputsAgainstTheLimit) {
  MemoryBudget budget(std::uint64_t{128} << 20, 2);
  const std::uint64_t before = budget.available();

  const auto few = reserve_names(std::vector<std::string>(1000, "scan.las"), budget);
  const auto many = reserve_names(std::vector<std::string>(100000, "scan.las"), budget);

  ASSERT_TRUE(few);
  EXPECT_EQ(before - budget.available(), few->bytes());
  EXPECT_GE(few->bytes(), 1000000u);
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().fault, Fault::kMemoryLimit);
  EXPECT_NE(many.error().message.find("100000 inputs"), std::string::npos);
}

}  // namespace
}  // namespace pss
