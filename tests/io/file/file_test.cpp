#include "io/file/file.h"

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

TEST(File, IsCreatedOnlyWhereTheNameIsFree) {
  TemporaryDirectory directory;
  write_text_file(directory / "precious", "precious");
  std::filesystem::create_symlink("precious", directory.path() / "link");
  std::filesystem::create_symlink("nowhere", directory.path() / "broken");

  for (const char* name : {"precious", "link", "broken"})
    EXPECT_FALSE(File::create(directory / name)) << name;

  EXPECT_EQ(read_text_file(directory / "precious"), "precious");
  EXPECT_FALSE(exists(directory / "nowhere"));
}

TEST(File, IsCreatedAnewInPlaceOfAFileButNotOfALink) {
  TemporaryDirectory directory;
  write_text_file(directory / "left", "over");
  write_text_file(directory / "precious", "precious");
  std::filesystem::create_symlink("precious", directory.path() / "link");
  std::filesystem::create_hard_link(directory.path() / "precious", directory.path() / "hard");

  const auto anew = File::create_anew(directory / "left");
  const auto link = File::create_anew(directory / "link");
  const auto hard = File::create_anew(directory / "hard");

  ASSERT_TRUE(anew && hard);
  EXPECT_EQ(read_text_file(directory / "left"), "");
  ASSERT_FALSE(link);
  EXPECT_NE(link.error().message.find("move it elsewhere"), std::string::npos);
  EXPECT_EQ(read_text_file(directory / "precious"), "precious");
}

TEST(File, IsOpenedToWriteByItsOnlyName) {
  TemporaryDirectory directory;
  for (const char* name : {"own", "target", "twin"}) write_text_file(directory / name, "x");
  std::filesystem::create_symlink("target", directory.path() / "link");
  std::filesystem::create_hard_link(directory.path() / "twin", directory.path() / "hard");

  EXPECT_TRUE(File::open_to_write(directory / "own"));
  for (const char* name : {"link", "hard", "twin", "missing"})
    EXPECT_FALSE(File::open_to_write(directory / name)) << name;
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

  EXPECT_TRUE(remove_file(directory / "missing"));
}

TEST(Files, ReplaceFileWritesThroughNoLink) {
  TemporaryDirectory directory;
  write_text_file(directory / "precious", "precious");
  std::filesystem::create_symlink("precious", directory.path() / "a.new");

  EXPECT_FALSE(replace_file(directory / "a", bytes_of("new")));

  EXPECT_EQ(read_text_file(directory / "precious"), "precious");
}

TEST(Files, AnOwnDirectoryGoesWholeOrNotAtAll) {
  TemporaryDirectory directory;
  const auto ours = [](const std::string& name) { return is_numbered(name, "run-"); };
  std::filesystem::create_directory(directory.path() / "runs");
  write_text_file(directory / "runs/run-000001", "x");
  write_text_file(directory / "runs/run-1", "somebody's");
  std::filesystem::create_directory_symlink("runs", directory.path() / "link");

  const auto foreign = remove_own_directory(directory / "runs", ours);
  const auto link = remove_own_directory(directory / "link", ours);

  ASSERT_FALSE(foreign);
  EXPECT_NE(foreign.error().message.find("run-1,"), std::string::npos) << foreign.error().message;
  EXPECT_FALSE(link);
  EXPECT_TRUE(exists(directory / "runs/run-000001"));
  EXPECT_TRUE(remove_file(directory / "runs/run-1"));
  EXPECT_TRUE(remove_own_directory(directory / "runs", ours));
  EXPECT_FALSE(exists(directory / "runs"));
}

TEST(Files, AnOwnDirectoryIsNoLink) {
  TemporaryDirectory directory;
  std::filesystem::create_directory(directory.path() / "theirs");
  std::filesystem::create_directory_symlink("theirs", directory.path() / "link");

  EXPECT_TRUE(make_own_directory(directory / "new"));
  EXPECT_TRUE(make_own_directory(directory / "new"));
  EXPECT_FALSE(make_own_directory(directory / "link"));
}

TEST(Files, ExchangeSwapsTwoNamesOrSaysThatItCannot) {
  TemporaryDirectory directory;
  write_text_file(directory / "a", "1");
  write_text_file(directory / "b", "2");

  const auto exchanged = exchange_names(directory / "a", directory / "b");

  ASSERT_TRUE(exchanged) << exchanged.error().message;
  // A file system that cannot exchange names says so, and leaves both as they were.
  EXPECT_EQ(read_text_file(directory / "a"), *exchanged ? "2" : "1");
  EXPECT_EQ(read_text_file(directory / "b"), *exchanged ? "1" : "2");
}

}  // namespace
}  // namespace pss::test
