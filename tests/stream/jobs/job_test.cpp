#include "stream/jobs/job.h"

#include <gtest/gtest.h>
#include <utime.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "stream/jobs/run_job.h"
#include "stream/jobs/smooth_kind.h"
#include "stream/sort/run_log.h"
#include "stream/store/manifest.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

JobRequest places(std::vector<std::string> inputs, std::string output, std::string work_dir) {
  JobRequest request;
  request.inputs = std::move(inputs);
  request.output = std::move(output);
  request.work_dir = std::move(work_dir);
  return request;
}

TEST(Places, OfAJobMustNotEndangerEachOther) {
  test::TemporaryDirectory folder;
  std::ofstream(folder / "a.las") << "points";
  const std::string work = folder / "w";

  EXPECT_TRUE(check_places(places({folder / "a.las"}, folder / "b.las", work)));
  EXPECT_FALSE(check_places(places({work + "/a.las"}, folder / "b.las", work)));
  EXPECT_FALSE(check_places(places({folder / "a.las"}, work + "/../w/b.las", work)));
  EXPECT_FALSE(check_places(places({folder / "a.las"}, folder / "b.las", folder.path().string())));
  EXPECT_TRUE(exists(folder / "a.las"));
}

TEST(Places, OfAStoreThatIsReplacedHoldNoInput) {
  test::TemporaryDirectory folder;
  expect_ok(make_directories(folder / "s.pss"));
  std::ofstream(folder / "s.pss/a.las") << "points";

  EXPECT_FALSE(check_places(places({folder / "s.pss/a.las"}, folder / "s.pss", folder / "w")));
}

TEST(Places, OfAStoreLieOnOneDisk) {
  test::TemporaryDirectory folder;
  ASSERT_FALSE(same_disk(folder.path().string(), "/proc"));  // where no file is kept

  EXPECT_TRUE(check_places(places({}, folder / "s.pss", folder / "w")));
  EXPECT_FALSE(check_places(places({}, folder / "s.pss", "/proc/w")));
  EXPECT_TRUE(check_places(places({}, folder / "s.las", "/proc/w")));
}

class JobStages : public ::testing::Test {
 protected:
  JobStages() {
    std::ofstream(folder_ / "a.las") << "points";
    places_.inputs = {folder_ / "a.las"};
    places_.output = folder_ / "out.las";
    places_.state_folder = folder_ / "state";
  }

  JobRecord record() const {
    JobRecord record;
    record.command = "smooth";
    record.output = places_.output;
    record.sorting = R"({"tile-points":9})";
    record.parameters = parameters_;
    record.passes = {"smooth"};
    record.inputs = {expect_value(fingerprint(places_.inputs[0]))};
    return record;
  }
  Result<Job> enter() { return Job::enter(places_, record(), monitor_); }
  void write_output(Job& job, const std::string& text) {
    auto file = OutputFile::create(places_.output, job.output_rules());
    ASSERT_TRUE(file && file->append(text)) << file.error().message;
    expect_ok(file->finish());
  }
  void run_to_the_end() {
    Job job = expect_value(enter());
    write_output(job, "result");
    expect_ok(job.leave());
  }
  /// A store of one tile where the job keeps its sorted input or its result.
  void make_store(const std::string& path, std::uint64_t seed = 5) const {
    StoreHeader header;
    header.schema = test::rich_schema();
    const test::Cloud cloud = test::random_cloud(20, 1000, header.schema.row_size(), seed);
    StoreWriter writer = expect_value(StoreWriter::create(path, header));
    expect_ok(test::append_tile(writer, header.schema, cloud, 0, 20));
    expect_ok(writer.finish("{}"));
  }
  bool work_is_there() const { return exists(places_.work_directory()); }

  test::TemporaryDirectory folder_;
  JobRequest places_;
  std::string parameters_ = R"({"radius":1.5})";
  Monitor monitor_;
};

TEST_F(JobStages, LeaveTheOutputAloneAndKnowItAgain) {
  run_to_the_end();

  EXPECT_FALSE(work_is_there());
  EXPECT_TRUE(expect_value(enter()).complete());
  EXPECT_FALSE(work_is_there());
}

TEST_F(JobStages, KnowNoOutputThatChangedThoughSizeAndTimeAreTheSame) {
  run_to_the_end();
  const auto time = std::filesystem::last_write_time(places_.output);
  std::ofstream(places_.output) << "resulT";
  std::filesystem::last_write_time(places_.output, time);

  const auto again = enter();

  ASSERT_FALSE(again);
  EXPECT_NE(again.error().message.find("exists"), std::string::npos);
  EXPECT_FALSE(work_is_there());
}

TEST_F(JobStages, KnowTheOutputOfNoOtherJob) {
  run_to_the_end();
  parameters_ = R"({"radius":2})";
  EXPECT_FALSE(enter());
  parameters_ = R"({"radius":1.5})";
  std::ofstream(places_.inputs[0]) << "others";
  EXPECT_FALSE(enter());
}

TEST_F(JobStages, RefuseToReplaceWhereTheMemoryOfThemIsLost) {
  run_to_the_end();
  std::filesystem::remove_all(places_.state_folder);
  EXPECT_FALSE(enter());
  places_.state_folder = "";
  EXPECT_FALSE(enter());
}

TEST_F(JobStages, KeepTheirRecordInAFolderThatWasNamed) {
  places_.work_dir = folder_ / "w";
  places_.state_folder = "";
  run_to_the_end();

  EXPECT_TRUE(exists(folder_ / "w/job.json"));
  EXPECT_TRUE(expect_value(enter()).complete());
}

TEST_F(JobStages, KnowTheirOutputWhenStoppedJustAfterTheRename) {
  {
    Job job = expect_value(enter());
    make_store(job.work().pass_store("smooth"));
    write_output(job, "result");
  }
  EXPECT_TRUE(expect_value(enter()).complete());
  EXPECT_FALSE(work_is_there());
}

TEST_F(JobStages, AreResumedWithEqualParametersOnly) {
  { make_store(expect_value(enter()).work().pass_store("smooth")); }
  EXPECT_TRUE(expect_value(enter()).resumed());
  parameters_ = R"({"radius":2})";

  const auto other = enter();

  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("--radius was 1.5, is 2 now"), std::string::npos);
  EXPECT_NE(other.error().message.find("--restart"), std::string::npos);
  places_.restart = true;
  EXPECT_FALSE(expect_value(enter()).resumed());
}

TEST_F(JobStages, GoOnWithSortedPointsWhateverIsToBeComputed) {
  { make_store(expect_value(enter()).work().input_store()); }
  parameters_ = R"({"radius":2})";

  const Job job = expect_value(enter());

  EXPECT_TRUE(job.resumed());
  EXPECT_TRUE(is_store(job.work().input_store()));
  EXPECT_EQ((*expect_value(job.work().read_record())).parameters, parameters_);
}

TEST_F(JobStages, LeaveNothingWhereTheyFailBeforeAnythingIsSorted) {
  Job job = expect_value(enter());

  const Error why = job.fail({Fault::kBadInput, "a sentence"});

  EXPECT_EQ(why.message, "a sentence");
  EXPECT_FALSE(work_is_there());
}

TEST_F(JobStages, LeaveAForeignFileInTheirDirectory) {
  Job job = expect_value(enter());
  std::ofstream(job.work().path() + "/thesis.txt") << "keep me";

  static_cast<void>(job.fail({Fault::kFailed, ""}));

  EXPECT_TRUE(exists(places_.work_directory() + "/thesis.txt"));
  EXPECT_FALSE(exists(places_.work_directory() + "/job.json"));
}

TEST_F(JobStages, BeginAgainAfterAnInputChangedWhileItWasRead) {
  {
    Job job = expect_value(enter());
    make_store(job.work().input_store());
    std::ofstream(places_.inputs[0]) << "changed";
    static_cast<void>(job.fail({Fault::kFailed, "it has changed"}));
  }
  const auto spoiled = expect_value(read_job_record(places_.work_directory()));
  ASSERT_TRUE(spoiled);
  EXPECT_NE(spoiled->spoiled.find("a.las"), std::string::npos) << spoiled->spoiled;

  const Job job = expect_value(enter());

  EXPECT_FALSE(job.resumed());
  EXPECT_FALSE(is_store(job.work().input_store()));
  EXPECT_TRUE(job.record().spoiled.empty());
}

TEST_F(JobStages, LeaveAFileAloneThatCameWhileTheyWorked) {
  { make_store(expect_value(enter()).work().input_store()); }
  std::ofstream(places_.output) << "somebody's";

  EXPECT_FALSE(enter());
  places_.overwrite = true;
  EXPECT_TRUE(expect_value(enter()).resumed());
}

TEST_F(JobStages, BeginAgainWhenTheOutputIsGone) {
  run_to_the_end();
  std::filesystem::remove(places_.output);

  const Job job = expect_value(enter());

  EXPECT_FALSE(job.complete() || job.resumed());
}

TEST_F(JobStages, EndTheDiscardingThatWasStopped) {
  {
    Job job = expect_value(enter());
    make_store(job.work().pass_store("smooth"));
    JobRecord discarded = job.record();
    discarded.discarding = true;
    expect_ok(job.work().write_record(discarded));
    std::filesystem::remove(manifest_path(job.work().pass_store("smooth")));
  }
  parameters_ = R"({"radius":2})";

  EXPECT_FALSE(expect_value(enter()).resumed());
}

TEST_F(JobStages, PutTheNewStoreInPlaceOfTheOldOne) {
  places_.output = folder_ / "out.pss";
  make_store(places_.output);
  places_.overwrite = true;
  Job job = expect_value(enter());
  make_store(job.work().pass_store("smooth"), 6);
  const auto old_bytes = test::bytes_of(places_.output + "/segment-000000");
  const auto new_bytes = test::bytes_of(job.work().pass_store("smooth") + "/segment-000000");
  ASSERT_NE(old_bytes, new_bytes);

  expect_ok(job.hand_over_store(job.work().pass_store("smooth")));

  EXPECT_EQ(test::bytes_of(places_.output + "/segment-000000"), new_bytes);
  expect_ok(job.leave());
  EXPECT_FALSE(work_is_there());
}

TEST_F(JobStages, RefuseToReplaceWhatIsNoStoreBeforeTheyBegin) {
  places_.output = folder_ / "out.pss";
  places_.overwrite = true;
  expect_ok(make_directories(places_.output));
  std::ofstream(places_.output + "/segment-000001") << "somebody's";
  EXPECT_FALSE(enter());
  std::filesystem::remove(places_.output + "/segment-000001");
  make_store(places_.output);
  std::ofstream(places_.output + "/thesis.txt") << "keep me";
  EXPECT_FALSE(enter());
  EXPECT_FALSE(work_is_there());
}

TEST_F(JobStages, AreRunByOneProcessAtATime) {
  const Job job = expect_value(enter());

  const auto second = enter();

  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("is being written by process"), std::string::npos);
}

TEST(ResultSummary, OfOtherTypesIsNotTaken) {
  const SmoothJob job;
  SmoothKind kind(job);
  JobReport report;

  read_result_summary(R"({"store_bytes":7,"notes":3,"widths":{"h":"wide"}})", report, kind);
  read_result_summary(R"({"store_bytes":7})", report, kind);

  EXPECT_EQ(report.store_bytes, 7u);
}

}  // namespace
}  // namespace pss
