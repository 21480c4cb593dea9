#include "io/watched_reader.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "tests/io/point_files.h"
#include "tests/support/changes.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

using std::chrono::file_clock;

/// A text of three points, and its record.
class WatchedReaderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text_file(path_, "1 2 3\n4 5 6\n7 8 9\n");
    const auto record = settled_fingerprint(path_);
    ASSERT_TRUE(record) << record.error().message;
    record_ = *record;
  }

  /// Reads a file of three points two at a time, and does something behind the first two.
  template <class Act>
  Result<PointBatch> read_and(Act act, std::optional<std::uint64_t> count = {}) {
    PSS_ASSIGN(const std::unique_ptr<Reader> reader,
               open_watched(record_, HeadBytes::kKept, count));
    PointBatch batch;
    PSS_TRY(reader->read(2, batch));
    act();
    return read_all(*reader, 2);
  }

  void expect_changed(const Result<PointBatch>& points) const {
    ASSERT_FALSE(points);
    EXPECT_EQ(points.error().fault, Fault::kFailed) << points.error().message;
    EXPECT_TRUE(points.error().message.starts_with(path_ + ": changed while it was read: found "))
        << points.error().message;
  }

  TemporaryDirectory folder_;
  std::string path_ = folder_ / "a.xyz";
  InputRecord record_;
};

TEST_F(WatchedReaderTest, GivesAllPointsOfAFileThatStaysAsItIs) {
  const auto points = read_and([] {}, 3);

  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->world, (std::vector<World3>{{7, 8, 9}}));
}

TEST_F(WatchedReaderTest, RefusesAFileThatChangesBetweenTwoPoints) {
  for (const Change change : kChanges) {
    SetUp();
    expect_changed(read_and([&] { make_change(change, path_); }));
  }
}

TEST_F(WatchedReaderTest, RefusesAFileThatVanishes) {
  const auto points = read_and([&] { std::filesystem::remove(path_); });

  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().fault, Fault::kFailed);
  EXPECT_TRUE(points.error().message.starts_with(
      path_ + ": cannot open: No such file or directory; expected 18 bytes, last changed "))
      << points.error().message;
}

TEST_F(WatchedReaderTest, RefusesAFileThatChangedBeforeItWasOpened) {
  write_text_file(path_, "1 2 3\n4 5 6\n7 8 8\n");

  expect_changed(read_and([] {}));
}

TEST_F(WatchedReaderTest, TellsDamageThatAChangeMadeFromDamageThatWasThere) {
  std::string text;  // longer than what is read at once
  while (text.size() < 300000) text += "1 2 3\n";
  const auto spoil = [&] { write_text_file(path_, text + "x y z\n" + text); };
  write_text_file(path_, text + "4 5 6\n" + text);
  record_ = *settled_fingerprint(path_);
  expect_changed(read_and(spoil));

  record_ = *settled_fingerprint(path_);
  const auto points = read_and([] {});

  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().fault, Fault::kBadInput) << points.error().message;
}

TEST_F(WatchedReaderTest, RefusesAnotherNumberOfPointsThanThereWas) {
  for (const std::uint64_t count : {2, 4}) expect_changed(read_and([] {}, count));
}

TEST_F(WatchedReaderTest, CountsFromTheRecordThatItWasSentTo) {
  const auto reader = open_watched(record_, HeadBytes::kKept, 3);
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_TRUE((*reader)->seek(2));

  const auto points = read_all(**reader);

  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->size(), 1u);
}

TEST_F(WatchedReaderTest, TheMessageSaysWhatWasFoundAndExpectedAndWhatToDo) {
  write_text_file(path_, "1 2 3\n");
  std::filesystem::last_write_time(
      path_, file_clock::from_sys(std::chrono::sys_days(std::chrono::year(2024) / 2 / 29) +
                                  std::chrono::milliseconds(1500)));
  record_.modified_ns = -1;
  const auto points = read_and([] {});

  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().message,
            path_ +
                ": changed while it was read: found 6 bytes, last changed 2024-02-29 "
                "00:00:01.500000000 UTC, expected 18 bytes, last changed 1969-12-31 "
                "23:59:59.999999999 UTC; nothing was written; run the command again once it is "
                "no longer written to");
}

TEST_F(WatchedReaderTest, ASettledRecordShowsEvenThatTheSameBytesWereWrittenAgain) {
  // Often, so that some fall within the step of the clock in which the file was written.
  for (int i = 0; i < 20; ++i) {
    write_text_file(path_, std::string(1000, '1'));
    const auto record = settled_fingerprint(path_);
    ASSERT_TRUE(record) << record.error().message;

    overwrite_middle(path_);

    EXPECT_FALSE(check_unchanged(*record)) << i;
  }
}

}  // namespace
}  // namespace pss::test
