// Files that change while convert() reads them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/convert.h"
#include "tests/io/point_files.h"
#include "tests/support/changes.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

constexpr int kPoints = 150000;  // three of the batches that convert() reads

class ChangedInputsOfConvert : public ::testing::Test {
 protected:
  /// A scan in the format of its extension.
  std::string scan(const std::string& extension) {
    std::string text;
    for (int i = 0; i < kPoints; ++i) text += fmt::format("{} {} {}\n", i % 1000, i / 1000, i % 7);
    write_text_file(folder_ / "points.xyz", text);
    const std::string path = folder_ / ("scan." + extension);
    Monitor monitor;
    const auto made = convert({folder_ / "points.xyz"}, path, {.overwrite = true}, monitor);
    EXPECT_TRUE(made) << made.error().message;
    return path;
  }

  void expect_refused(const std::vector<std::string>& inputs, const std::string& output,
                      const std::string& changed, ActingMonitor& monitor) {
    const auto result = convert(inputs, folder_ / output, {}, monitor);
    EXPECT_TRUE(monitor.acted());
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().fault, Fault::kFailed) << result.error().message;
    for (const std::string& words : {changed, std::string("changed while it was read")})
      EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
    EXPECT_FALSE(std::filesystem::exists(folder_ / output));
    EXPECT_FALSE(std::filesystem::exists(folder_ / (output + ".part")));
  }

  TemporaryDirectory folder_;
};

TEST_F(ChangedInputsOfConvert, AreRefusedWhateverTheFormatAndTheChange) {
  for (const char* extension : {"las", "ply", "xyz"})
    for (const Change change : kChanges)
      for (const std::uint64_t points : {0, 70000, kPoints}) {
        SCOPED_TRACE(fmt::format("{} {} after {}", extension, name_of(change), points));
        const std::string input = scan(extension);
        ActingMonitor monitor("convert", points, [&] { make_change(change, input); });

        expect_refused({input}, "out.ply", input, monitor);
      }
}

TEST_F(ChangedInputsOfConvert, AreRefusedWhereTheyChangeWhileTheirBoundsAreMeasured) {
  for (const char* extension : {"ply", "xyz"})
    for (const Change change : kChanges) {
      SCOPED_TRACE(fmt::format("{} {}", extension, name_of(change)));
      const std::string input = scan(extension);
      ActingMonitor monitor("survey", 70000, [&] { make_change(change, input); });

      expect_refused({input}, "out.las", input, monitor);
    }
}

TEST_F(ChangedInputsOfConvert, AreRefusedWhereAnotherOneIsReadBeforeOrAfterwards) {
  for (const int changed : {0, 1}) {
    SCOPED_TRACE(changed);
    const std::vector<std::string> inputs{scan("las"), scan("ply")};
    // The second file is being read, or the first.
    const std::uint64_t points = changed == 0 ? kPoints + 70000 : 70000;
    const std::string& file = inputs[static_cast<std::size_t>(changed)];
    ActingMonitor monitor("convert", points, [&] { make_change(Change::kOverwritten, file); });

    expect_refused(inputs, "out.xyz", file, monitor);
  }
}

TEST_F(ChangedInputsOfConvert, AreRefusedWhereTheyVanish) {
  const std::vector<std::string> inputs{scan("las"), scan("ply")};
  ActingMonitor monitor("convert", 70000, [&] { std::filesystem::remove(inputs[1]); });

  const auto result = convert(inputs, folder_ / "out.xyz", {}, monitor);

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().fault, Fault::kFailed);
  EXPECT_NE(result.error().message.find(inputs[1]), std::string::npos) << result.error().message;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.xyz"));
}

}  // namespace
}  // namespace pss::test
