#include "io/file/output_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

TEST(OutputFile, HasItsNameOnlyOnceItIsComplete) {
  TemporaryDirectory directory;
  const std::string path = directory / "out";
  auto file = OutputFile::create(path, {});
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append("hello"));
  EXPECT_FALSE(exists(path));

  ASSERT_TRUE(file->finish());

  EXPECT_EQ(read_text_file(path), "hello");
}

TEST(OutputFile, LeavesItsNameAlone) {
  TemporaryDirectory directory;
  {
    auto file = OutputFile::create(directory / "out", {});
    ASSERT_TRUE(file && file->append("hello") && file->finish());
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
}

TEST(OutputFile, TellsItsContentBeforeItHasItsName) {
  TemporaryDirectory directory;
  Monitor monitor;
  std::optional<WrittenFile> told;
  auto file =
      OutputFile::create(directory / "out", {.before_rename = [&](const WrittenFile& whole) {
                           told = whole;
                           return exists(directory / "out") ? Error{} : Result<void>();
                         }});
  ASSERT_TRUE(file);
  const std::string text(9000001, 'x');  // three pieces of the hash; the header's piece changes
  ASSERT_TRUE(file->append(text) && file->patch(5, bytes_of("PATCHED")));

  ASSERT_TRUE(file->finish());

  const auto found = content_of(directory / "out", monitor);
  ASSERT_TRUE(found && told);
  EXPECT_TRUE(same_bytes(told->content, *found));
  EXPECT_EQ(told->content.modified_ns, found->modified_ns);
  EXPECT_EQ(found->size, text.size());
}

TEST(OutputFile, IsNotWrittenBesideAnotherOfItsName) {
  TemporaryDirectory directory;
  auto first = OutputFile::create(directory / "out", {.overwrite = true});

  const auto second = OutputFile::create(directory / "out", {.overwrite = true});

  ASSERT_TRUE(first);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find(fmt::format("process {} on ", getpid())), std::string::npos)
      << second.error().message;
}

TEST(OutputFile, LeavesNothingWhenItIsNotFinished) {
  TemporaryDirectory directory;
  {
    auto file = OutputFile::create(directory / "out", {});
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->append("hello"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(OutputFile, AppendsAnySizesAndPatchesAnyPlace) {
  TemporaryDirectory directory;
  std::string expected;
  auto file = OutputFile::create(directory / "out", {});
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

  const auto file = OutputFile::create(directory / "out", {});

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().fault, Fault::kFailed);
  EXPECT_NE(file.error().message.find("use --overwrite"), std::string::npos);
  EXPECT_EQ(read_text_file(directory / "out"), "precious");
}

TEST(OutputFile, RefusesANameThatWasTakenMeanwhile) {
  TemporaryDirectory directory;
  {
    auto file = OutputFile::create(directory / "out", {});
    ASSERT_TRUE(file);
    write_text_file(directory / "out", "precious");

    const auto outcome = file->finish();

    ASSERT_FALSE(outcome);
    EXPECT_NE(outcome.error().message.find("exists"), std::string::npos);
  }
  EXPECT_EQ(read_text_file(directory / "out"), "precious");
}

TEST(OutputFile, ReplacesAnExistingFileOnlyAtTheEnd) {
  TemporaryDirectory directory;
  write_text_file(directory / "out", "old");
  auto file = OutputFile::create(directory / "out", {.overwrite = true});
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append("new"));
  EXPECT_EQ(read_text_file(directory / "out"), "old");

  ASSERT_TRUE(file->finish());

  EXPECT_EQ(read_text_file(directory / "out"), "new");
}

TEST(OutputFile, RefusesADirectoryAndAMissingDirectory) {
  TemporaryDirectory directory;
  std::filesystem::create_directory(directory.path() / "d");

  EXPECT_FALSE(OutputFile::create(directory / "d", {.overwrite = true}));
  EXPECT_FALSE(OutputFile::create(directory / "missing/out", {.overwrite = true}));
}

TEST(OutputFile, WhoseNoteFailsHasNoName) {
  TemporaryDirectory directory;
  {
    auto file = OutputFile::create(directory / "out",
                                   {.before_rename = [](const WrittenFile&) { return Error{}; }});
    ASSERT_TRUE(file && file->append("x"));
    EXPECT_FALSE(file->finish());
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

}  // namespace
}  // namespace pss::test
