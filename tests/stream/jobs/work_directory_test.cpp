#include "stream/jobs/work_directory.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "stream/store/manifest.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

JobRecord some_record() {
  JobRecord record;
  record.command = "smooth";
  record.output = "out.las";
  record.sorting = record.parameters = "{}";
  return record;
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

  expect_ok(work.clear(some_record()));

  EXPECT_FALSE(exists(work.input_store()));
  EXPECT_FALSE(exists(folder / "w/job.json"));
  EXPECT_TRUE(exists(folder / "w/thesis.txt"));
}

TEST(WorkDirectory, IsNobodyElsesWhateverItIsAskedFor) {
  for (const char* text : {"{\"command\": 3", "{}", "", R"({"program":"other","checksum":""})"}) {
    test::TemporaryDirectory folder;
    expect_ok(make_directories(folder / "w/runs"));
    std::ofstream(folder / "w/job.json") << text;
    std::ofstream(folder / "w/runs/thesis.txt") << "keep me";

    const auto work = WorkDirectory::open(folder / "w");

    ASSERT_FALSE(work) << text;
    EXPECT_NE(work.error().message.find("job.json"), std::string::npos);
    EXPECT_TRUE(exists(folder / "w/runs/thesis.txt"));
  }
}

TEST(WorkDirectory, RefusesARecordNestedWithoutEnd) {
  test::TemporaryDirectory folder;
  expect_ok(make_directories(folder / "w"));
  const std::string open(1000000, '['), close(1000000, ']');
  std::ofstream(folder / "w/job.json") << R"({"checksum":"","parameters":)" << open << close << "}";

  EXPECT_FALSE(read_job_record(folder / "w"));
}

TEST(WorkDirectory, RefusesLinksUnderTheNamesOfAJob) {
  for (const char* name : {"runs", "input.pss", "normals.pss", "smooth.pss", "replaced.pss"}) {
    test::TemporaryDirectory folder;
    expect_ok(make_directories(folder / "theirs"));
    { expect_ok(expect_value(WorkDirectory::open(folder / "w")).write_record(some_record())); }
    std::filesystem::create_directory_symlink(folder / "theirs",
                                              folder / (std::string("w/") + name));

    const auto work = WorkDirectory::open(folder / "w");

    ASSERT_FALSE(work) << name;
    EXPECT_NE(work.error().message.find(name), std::string::npos);
  }
}

TEST(WorkDirectory, IsRemovedWithEverythingOfAJob) {
  test::TemporaryDirectory folder;
  WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));
  expect_ok(work.write_record(some_record()));
  for (const std::string& path : {work.runs(), work.replaced_store(), folder / "w/probe"})
    expect_ok(make_directories(path));

  expect_ok(WorkDirectory::remove(std::move(work), some_record()));

  EXPECT_FALSE(exists(folder / "w"));
}

TEST(WorkDirectory, ProbesTheRenameOfAStoreAndLeavesNothing) {
  test::TemporaryDirectory folder;
  const WorkDirectory work = expect_value(WorkDirectory::open(folder / "w"));

  EXPECT_TRUE(work.probe_rename(folder / "to"));
  EXPECT_FALSE(work.probe_rename(folder / "missing/to"));

  EXPECT_FALSE(exists(folder / "to") || exists(folder / "w/probe"));
}

}  // namespace
}  // namespace pss
