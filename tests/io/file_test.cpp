#include "io/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

TEST(File, ReadsWhatWasWrittenAtAnyOffset) {
  TemporaryDirectory directory;
  auto file = File::create(directory / "a");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write(3, bytes_of("abc")));
  std::string got(6, 'x');

  ASSERT_TRUE(file->read(0, std::as_writable_bytes(std::span(got))));

  EXPECT_EQ(got, std::string("\0\0\0abc", 6));
  EXPECT_EQ(*file->size(), 6u);
}

TEST(File, ReadsLessOnlyAtTheEnd) {
  TemporaryDirectory directory;
  write_text_file(directory / "a", "0123456789");
  const auto file = File::open(directory / "a");
  std::string got(8, 'x');

  EXPECT_EQ(*file->read_some(4, std::as_writable_bytes(std::span(got))), 6u);
  EXPECT_EQ(*file->read_some(10, std::as_writable_bytes(std::span(got))), 0u);
  EXPECT_EQ(*file->read_some(~std::uint64_t{0}, std::as_writable_bytes(std::span(got))), 0u);
  EXPECT_EQ(got, "456789xx");
}

TEST(File, ShortFileIsBadInputWithOffsetFoundAndExpected) {
  TemporaryDirectory directory;
  write_text_file(directory / "short", "0123");
  const auto file = File::open(directory / "short");
  std::string got(8, 'x');

  const auto outcome = file->read(1, std::as_writable_bytes(std::span(got)));

  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().fault, Fault::kBadInput);
  for (const char* part : {"short", "offset 1", "found 3", "expected 8"})
    EXPECT_NE(outcome.error().message.find(part), std::string::npos) << outcome.error().message;
}

TEST(File, RefusesWhatIsNoRegularFile) {
  TemporaryDirectory directory;
  ASSERT_EQ(mkfifo((directory / "pipe").c_str(), 0600), 0);

  for (const std::string& path : {directory / "missing", directory.path().string(),
                                  directory / "pipe", std::string("/dev/zero")}) {
    const auto file = File::open(path);
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().fault, Fault::kFailed);
    EXPECT_NE(file.error().message.find(path), std::string::npos) << file.error().message;
  }
}

TEST(File, FullDiskIsAnErrorWithThePath) {
  auto file = File::create("/dev/full");
  ASSERT_TRUE(file) << file.error().message;

  const auto outcome = file->write(0, bytes_of("x"));

  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().fault, Fault::kFailed);
  EXPECT_NE(outcome.error().message.find("/dev/full"), std::string::npos);
}

TEST(File, FailedSyncIsFinal) {
  TemporaryDirectory directory;
  ASSERT_EQ(mkfifo((directory / "pipe").c_str(), 0600), 0);
  auto pipe = File::open_or_create(directory / "pipe");  // a pipe cannot be synced
  ASSERT_TRUE(pipe);

  EXPECT_FALSE(pipe->sync());
  const auto write = pipe->write(0, bytes_of("x"));
  ASSERT_FALSE(write);
  EXPECT_NE(write.error().message.find("failed sync"), std::string::npos);
  EXPECT_FALSE(pipe->sync());
}

TEST(OutputFile, HasItsNameOnlyOnceItIsComplete) {
  TemporaryDirectory directory;
  const std::string path = directory / "out";
  auto file = OutputFile::create(path, false);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append("hello"));
  EXPECT_FALSE(exists(path));
  EXPECT_TRUE(exists(path + ".part"));

  ASSERT_TRUE(file->finish());

  EXPECT_EQ(read_text_file(path), "hello");
  EXPECT_FALSE(exists(path + ".part"));
}

TEST(OutputFile, LeavesNothingWhenItIsNotFinished) {
  TemporaryDirectory directory;
  {
    auto file = OutputFile::create(directory / "out", false);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->append("hello"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(OutputFile, AppendsAnySizesAndPatchesAnyPlace) {
  TemporaryDirectory directory;
  std::string expected;
  auto file = OutputFile::create(directory / "out", false);
  ASSERT_TRUE(file);
  // Around the buffer's 1 MiB: below, at, above, and pieces that cross it.
  for (const std::size_t size : {1u, 1048575u, 1048576u, 1048577u, 700000u, 700000u, 0u, 3u}) {
    const std::string piece(size, static_cast<char>('a' + expected.size() % 26));
    ASSERT_TRUE(file->append(piece));
    expected += piece;
  }
  EXPECT_EQ(file->position(), expected.size());
  for (const std::size_t place : {std::size_t{0}, std::size_t{1048570}, expected.size() - 9}) {
    ASSERT_TRUE(file->patch(place, bytes_of("PATCHED!!")));
    expected.replace(place, 9, "PATCHED!!");
  }

  ASSERT_TRUE(file->finish());

  EXPECT_TRUE(read_text_file(directory / "out") == expected);
}

TEST(OutputFile, RefusesAnExistingNameFromTheStart) {
  TemporaryDirectory directory;
  write_text_file(directory / "out", "precious");

  const auto file = OutputFile::create(directory / "out", false);

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().fault, Fault::kFailed);
  EXPECT_NE(file.error().message.find("use --overwrite"), std::string::npos);
  EXPECT_EQ(read_text_file(directory / "out"), "precious");
}

TEST(OutputFile, RefusesANameThatWasTakenMeanwhile) {
  TemporaryDirectory directory;
  {
    auto file = OutputFile::create(directory / "out", false);
    ASSERT_TRUE(file);
    write_text_file(directory / "out", "precious");

    const auto outcome = file->finish();

    ASSERT_FALSE(outcome);
    EXPECT_NE(outcome.error().message.find("exists"), std::string::npos);
  }
  EXPECT_EQ(read_text_file(directory / "out"), "precious");
  EXPECT_FALSE(exists(directory / "out.part"));
}

TEST(OutputFile, ReplacesAnExistingFileOnlyAtTheEnd) {
  TemporaryDirectory directory;
  write_text_file(directory / "out", "old");
  auto file = OutputFile::create(directory / "out", true);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append("new"));
  EXPECT_EQ(read_text_file(directory / "out"), "old");

  ASSERT_TRUE(file->finish());

  EXPECT_EQ(read_text_file(directory / "out"), "new");
}

TEST(OutputFile, RefusesADirectoryAndAMissingDirectory) {
  TemporaryDirectory directory;
  std::filesystem::create_directory(directory.path() / "d");

  EXPECT_FALSE(OutputFile::create(directory / "d", true));
  EXPECT_FALSE(OutputFile::create(directory / "missing/out", true));
}

TEST(OutputFile, FullDiskFailsAndLeavesNothing) {
  TemporaryDirectory directory;
  {
    // NAME.part leads to a full device: every flush fails as on a full disk.
    std::filesystem::create_symlink("/dev/full", directory.path() / "out.part");
    auto file = OutputFile::create(directory / "out", false);
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_TRUE(file->append("x"));
    EXPECT_FALSE(file->finish());
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Files, ReadWholeRefusesMoreThanItsLimit) {
  TemporaryDirectory directory;
  write_text_file(directory / "a", "12345");

  EXPECT_EQ(read_whole(directory / "a", 5)->size(), 5u);
  EXPECT_FALSE(read_whole(directory / "a", 4));
}

TEST(Files, ReplaceFileReplacesTheWholeContent) {
  TemporaryDirectory directory;
  write_text_file(directory / "a", "a long old content");

  ASSERT_TRUE(replace_file(directory / "a", bytes_of("new")));

  EXPECT_EQ(read_text_file(directory / "a"), "new");
}

TEST(Files, DirectoryOfIsTheParentOrHere) {
  EXPECT_EQ(directory_of("a/b/c"), "a/b");
  EXPECT_EQ(directory_of("c"), ".");
  EXPECT_EQ(directory_of("/c"), "/");
}

TEST(Files, StoresHaveNamesThatEndInPss) {
  for (const char* name : {"a.pss", "a.pss/", "in/b.c.pss", "/a.pss//"})
    EXPECT_TRUE(is_store_name(name)) << name;
  for (const char* name : {"a.las", "pss", "a.pss/b.las", "a.pss.work", "", "/"})
    EXPECT_FALSE(is_store_name(name)) << name;
}

TEST(Files, FreeSpaceIsKnownForNamesThatAreNotThereYet) {
  TemporaryDirectory directory;

  const auto space = free_space(directory / "not/yet/there");

  ASSERT_TRUE(space) << space.error().message;
  EXPECT_GT(*space, 0u);
}

TEST(Files, RemovingAMissingFileIsNoError) {
  TemporaryDirectory directory;

  EXPECT_TRUE(remove_all(directory / "missing"));
}

}  // namespace
}  // namespace pss::test
