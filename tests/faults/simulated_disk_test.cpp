#include "tests/support/simulated_disk.h"

#include <gtest/gtest.h>

#include <cerrno>

#include "io/file/file.h"

namespace pss::test {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(const SimulatedDisk& disk, const std::string& path) {
  const auto bytes = disk.content(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A file "/a" with "old" synced and "new" written over it.
void write_old_and_new() {
  auto file = File::create("/a");
  ASSERT_TRUE(file && file->write(0, bytes_of("old")) && file->sync());
  ASSERT_TRUE(sync_directory("/") && file->write(0, bytes_of("new")));
}

TEST(SimulatedDisk, ForgetsWhatWasNotSynced) {
  SimulatedDisk disk;
  write_old_and_new();
  disk.restart(Crash::kForget, 1);
  EXPECT_EQ(text_of(disk, "/a"), "old");
}

TEST(SimulatedDisk, KeepsEverythingWhenOnlyTheProcessDies) {
  SimulatedDisk disk;
  write_old_and_new();
  disk.restart(Crash::kKeep, 1);
  EXPECT_EQ(text_of(disk, "/a"), "new");
}

TEST(SimulatedDisk, GarblesOnlyWhatWasNotSynced) {
  SimulatedDisk disk;
  write_old_and_new();
  auto file = File::create("/b");
  ASSERT_TRUE(file && file->write(0, bytes_of("safe")) && file->sync());
  disk.restart(Crash::kGarble, 1);
  EXPECT_EQ(text_of(disk, "/b"), "safe");
  EXPECT_NE(text_of(disk, "/a"), "old");
  EXPECT_NE(text_of(disk, "/a"), "new");
}

TEST(SimulatedDisk, TearsAFileBlockByBlockAndOutOfOrder) {
  bool first_only = false, second_only = false;
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    SimulatedDisk disk;
    auto file = File::create("/a");
    ASSERT_TRUE(file && file->write(0, bytes_of(std::string(1024, 'o'))) && file->sync());
    ASSERT_TRUE(sync_directory("/") && file->write(0, bytes_of(std::string(1024, 'n'))));
    disk.restart(Crash::kTear, seed);
    const std::string text = text_of(disk, "/a");
    ASSERT_EQ(text.size(), 1024u);
    first_only = first_only || text == std::string(512, 'n') + std::string(512, 'o');
    second_only = second_only || text == std::string(512, 'o') + std::string(512, 'n');
  }
  EXPECT_TRUE(first_only);
  EXPECT_TRUE(second_only);
}

TEST(SimulatedDisk, ForgetsANameUntilItsDirectoryIsSynced) {
  for (const bool synced : {false, true}) {
    SimulatedDisk disk;
    auto file = File::create("/a");
    ASSERT_TRUE(file && file->sync());
    ASSERT_TRUE(!synced || sync_directory("/"));
    disk.restart(Crash::kForget, 1);
    EXPECT_EQ(disk.has("/a"), synced);
  }
}

TEST(SimulatedDisk, BringsBackWhatWasRemovedButNotDurably) {
  SimulatedDisk disk;
  disk.put("/a", bytes_of("here"));
  ASSERT_TRUE(remove_file("/a"));
  EXPECT_FALSE(disk.has("/a"));
  disk.restart(Crash::kForget, 1);
  EXPECT_EQ(text_of(disk, "/a"), "here");
}

TEST(SimulatedDisk, LiesAfterAFailedSyncAsLinuxDoes) {
  SimulatedDisk disk;
  write_old_and_new();
  disk.set_fault([](Call call, const std::string&) { return call == Call::kSync ? EIO : 0; });
  EXPECT_FALSE(File::open_to_write("/a")->sync());
  disk.set_fault({});
  EXPECT_TRUE(File::open_to_write("/a")->sync());
  disk.restart(Crash::kForget, 1);
  EXPECT_EQ(text_of(disk, "/a"), "old");
}

TEST(SimulatedDisk, FailsEveryCallAfterACrashUntilTheRestart) {
  SimulatedDisk disk;
  disk.put("/a", bytes_of("here"));
  disk.crash_before(1);
  EXPECT_FALSE(remove_file("/a"));
  EXPECT_FALSE(File::open("/a"));
  disk.restart(Crash::kKeep, 1);
  EXPECT_TRUE(File::open("/a"));
}

TEST(SimulatedDisk, FillsUpAndHasRoomAgain) {
  SimulatedDisk disk;
  disk.set_capacity(5);
  auto file = File::create("/a");
  ASSERT_TRUE(file && file->write(0, bytes_of("1234")));
  EXPECT_FALSE(file->write(4, bytes_of("56")));
  EXPECT_TRUE(file->write(0, bytes_of("over")));
  disk.set_capacity(6);
  EXPECT_TRUE(file->write(4, bytes_of("56")));
}

}  // namespace
}  // namespace pss::test
