#include "io/inputs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

class InputsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"b.las", "a.las", "c d.ply", "notes.md", "x[1].las", "a.las.part"})
      write_text_file(directory_ / name, "content");
    std::filesystem::create_directory(directory_.path() / "store.pss");
    std::filesystem::create_directory(directory_.path() / "empty");
  }

  /// The names that arguments, relative to the directory, expand to; or the error's text.
  std::vector<std::string> expand(const std::vector<std::string>& names) {
    std::vector<std::string> arguments;
    for (const std::string& name : names) {
      const bool list = name.starts_with('@');
      arguments.push_back(directory_ / name.substr(list ? 1 : 0));
      if (list) arguments.back().insert(0, 1, '@');
    }
    auto paths = expand_inputs(arguments);
    if (!paths) {
      EXPECT_EQ(paths.error().fault, Fault::kFailed);
      return {paths.error().message};
    }
    for (std::string& path : *paths)
      path = std::filesystem::relative(path, directory_.path()).string();
    return *paths;
  }

  TemporaryDirectory directory_;
};

using Names = std::vector<std::string>;

TEST_F(InputsTest, KeepFilesInTheirOrder) {
  EXPECT_EQ(expand({"b.las", "a.las", "notes.md"}), (Names{"b.las", "a.las", "notes.md"}));
}

TEST_F(InputsTest, RefuseAFileThatIsThereTwiceByAnyName) {
  std::filesystem::create_symlink(directory_.path() / "a.las", directory_.path() / "link.las");
  std::filesystem::create_hard_link(directory_.path() / "a.las", directory_.path() / "hard.las");

  for (const char* again : {"a.las", "link.las", "hard.las", "empty/../a.las", "a.l*"}) {
    const auto paths =
        expand_inputs(std::vector{directory_ / "a.las", directory_ / "b.las", directory_ / again});

    ASSERT_FALSE(paths) << again;
    EXPECT_EQ(paths.error().fault, Fault::kUsage);
    EXPECT_NE(paths.error().message.find("same file"), std::string::npos);
  }
}

TEST_F(InputsTest, ExpandADirectoryToItsScansByName) {
  EXPECT_EQ(expand({""}), (Names{"a.las", "b.las", "c d.ply", "x[1].las"}));
}

TEST_F(InputsTest, TakeAStoreAsItIs) {
  EXPECT_EQ(expand({"store.pss"}), Names{"store.pss"});
  EXPECT_EQ(expand({"store.pss/"}).size(), 1u);
}

TEST_F(InputsTest, ExpandGlobsByNameUnlessAFileIsCalledSo) {
  EXPECT_EQ(expand({"?.las"}), (Names{"a.las", "b.las"}));
  EXPECT_EQ(expand({"*.ply", "a*s"}), (Names{"c d.ply", "a.las"}));
  EXPECT_EQ(expand({"x[1].las"}), Names{"x[1].las"});
}

TEST_F(InputsTest, ReadListsWithOnePathALine) {
  write_text_file(
      directory_ / "list.txt",
      directory_ / "b.las" + "\r\n\n" + (directory_ / "c d.ply") + "\n" + (directory_ / "a.*"));

  EXPECT_EQ(expand({"@list.txt", "notes.md"}),
            (Names{"b.las", "c d.ply", "a.las", "a.las.part", "notes.md"}));
}

TEST_F(InputsTest, NameWhatIsMissing) {
  for (const char* missing : {"missing.las", "*.e57", "@missing.txt", "empty"}) {
    const Names message = expand({"a.las", missing});
    ASSERT_EQ(message.size(), 1u);
    const std::string name = missing[0] == '@' ? missing + 1 : missing;
    EXPECT_NE(message[0].find(name), std::string::npos) << message[0];
  }
}

TEST_F(InputsTest, RefuseListsInListsAndEmptyLists) {
  write_text_file(directory_ / "list.txt", "@list.txt\n");
  EXPECT_NE(expand({"@list.txt"})[0].find("list in a list"), std::string::npos);
  write_text_file(directory_ / "list.txt", "\n\n");
  EXPECT_NE(expand({"@list.txt"})[0].find("no input"), std::string::npos);
}

TEST_F(InputsTest, LeaveTheOutputOutOfWhatIsFoundButNotOfWhatIsNamed) {
  const std::string output = directory_ / "b.las";
  const auto all = [&](const std::string& argument) {
    const auto paths = expand_inputs(std::vector{directory_ / argument}, output);
    return paths && std::ranges::any_of(*paths, [](const std::string& path) {
             return std::filesystem::path(path).filename() == "b.las";
           });
  };

  EXPECT_FALSE(all("."));
  EXPECT_FALSE(all("*.las"));
  EXPECT_TRUE(all("b.las"));
}

TEST_F(InputsTest, AreNeverAnOutputByAnyName) {
  std::filesystem::create_symlink(directory_.path() / "a.las", directory_.path() / "link.las");
  const std::vector<std::string> inputs{directory_ / "b.las", directory_ / "link.las"};

  for (const char* name : {"a.las", "link.las", "empty/../b.las"}) {
    const Result<void> checked = check_output(inputs, directory_ / name);

    ASSERT_FALSE(checked) << name;
    EXPECT_EQ(checked.error().fault, Fault::kUsage);
  }
  EXPECT_TRUE(check_output(inputs, directory_ / "c d.ply"));
  EXPECT_TRUE(check_output(inputs, directory_ / "new.las"));
}

TEST_F(InputsTest, HoldNoOutputWhereTheyAreStoresAndNoDirectoryIsOne) {
  const std::vector<std::string> inputs{directory_ / "store.pss"};

  const Result<void> within = check_output(inputs, directory_ / "empty/../store.pss/out.las");
  const Result<void> directory = check_output({}, directory_ / "empty");

  ASSERT_FALSE(within);
  EXPECT_EQ(within.error().fault, Fault::kUsage);
  ASSERT_FALSE(directory);
  EXPECT_NE(directory.error().message.find("is a directory"), std::string::npos);
  EXPECT_TRUE(check_output({}, directory_ / "store.pss")) << "a store may be replaced";
}

TEST_F(InputsTest, AreNoStoresWhereOnlyFilesAreRead) {
  const Result<void> checked =
      check_files(std::vector{directory_ / "a.las", directory_ / "store.pss"});

  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().fault, Fault::kUsage);
  EXPECT_NE(checked.error().message.find("pss export"), std::string::npos);
}

TEST_F(InputsTest, NameTheMissingFolderOfAnOutput) {
  const Result<void> checked = check_output({}, directory_ / "nowhere/out.las");

  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().fault, Fault::kFailed);
  EXPECT_NE(checked.error().message.find("folder is missing"), std::string::npos);
}

}  // namespace
}  // namespace pss::test
