#include "io/file/output_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "io/file/file.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

/// Takes the lock and starts to write, in a process that ends without any clearing up.
void die_writing(const std::string& path) {
  const pid_t child = fork();
  if (child == 0) {
    const auto lock = OutputLock::take(path);
    if (lock) std::ofstream(lock->temporary()) << "half of it";
    _exit(lock ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
}

TEST(OutputLock, IsHeldByOneAndLeavesNothing) {
  TemporaryDirectory directory;
  {
    const auto first = OutputLock::take(directory / "out");
    const auto second = OutputLock::take(directory / "out");
    const auto other = OutputLock::take(directory / "other");

    ASSERT_TRUE(first && other);
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().message.find("process " + std::to_string(getpid()) + " on "),
              std::string::npos)
        << second.error().message;
    EXPECT_TRUE(lock_holder(directory / "out"));
  }
  EXPECT_FALSE(lock_holder(directory / "out"));
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(OutputLock, OfADeadProcessIsTakenOverWithWhatItLeft) {
  TemporaryDirectory directory;
  die_writing(directory / "out");
  EXPECT_FALSE(std::filesystem::is_empty(directory.path()));

  { EXPECT_TRUE(OutputLock::take(directory / "out")); }

  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(OutputLock, LeavesATemporaryOfAnotherNumberAlone) {
  TemporaryDirectory directory;
  write_text_file(directory / ".out.1.pss-part", "somebody's");
  die_writing(directory / "out");

  { EXPECT_TRUE(OutputLock::take(directory / "out")); }

  EXPECT_EQ(read_text_file(directory / ".out.1.pss-part"), "somebody's");
}

TEST(OutputLock, RefusesWhatIsNoLockFileAndTouchesNothing) {
  using Make = std::function<void(const std::string& lock, const std::string& precious)>;
  const Make makes[] = {
      [](const auto& lock, const auto&) { write_text_file(lock, "precious"); },
      [](const auto& lock, const auto& file) { std::filesystem::create_symlink(file, lock); },
      [](const auto& lock, const auto& file) { std::filesystem::create_hard_link(file, lock); },
      [](const auto& lock, const auto&) { std::filesystem::create_directory(lock); },
      [](const auto& lock, const auto&) { std::filesystem::create_symlink("nowhere", lock); }};
  for (const Make& make : makes) {
    TemporaryDirectory directory;
    write_text_file(directory / "precious", "");  // empty, as a lock file is
    make(lock_name_of(directory / "out"), directory / "precious");

    const auto lock = OutputLock::take(directory / "out");

    ASSERT_FALSE(lock);
    EXPECT_NE(lock.error().message.find(".out.pss-lock"), std::string::npos);
    EXPECT_TRUE(exists(lock_name_of(directory / "out")));
    EXPECT_TRUE(exists(directory / "precious"));
    EXPECT_FALSE(exists(directory / "nowhere"));
  }
}

TEST(OutputLock, HasNamesThatFitForEveryNameThatFits) {
  TemporaryDirectory directory;
  for (const std::size_t size : {1u, 199u, 200u, 201u, 255u}) {
    const auto lock = OutputLock::take(directory / std::string(size, 'n'));
    ASSERT_TRUE(lock) << size << ": " << lock.error().message;
    write_text_file(lock->temporary(), "x");
    EXPECT_TRUE(exists(lock->temporary()));
    EXPECT_TRUE(remove_file(lock->temporary()));
  }
  const auto too_long = OutputLock::take(directory / std::string(256, 'n'));
  ASSERT_FALSE(too_long);
  EXPECT_NE(too_long.error().message.find("too long"), std::string::npos);
}

TEST(OutputLock, TellsLongNamesApart) {
  const std::string start(220, 'n');
  EXPECT_NE(lock_name_of(start + "a"), lock_name_of(start + "b"));
}

TEST(OutputLock, RefusesAMissingFolder) {
  TemporaryDirectory directory;
  EXPECT_FALSE(OutputLock::take(directory / "missing/out"));
}

}  // namespace
}  // namespace pss::test
