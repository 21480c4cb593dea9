// LAS grids that could not hold the points, or would make many of them one: refused before the
// first is written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>

#include "io/convert.h"
#include "io/open.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/named_numbers.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

World3 triple(const std::vector<double>& v) {
  return v.size() == 1 ? World3{v[0], v[0], v[0]} : World3{v.at(0), v.at(1), v.at(2)};
}

/// A flat grid of 60 x 60 points, one apart.
std::string unit_grid() {
  std::string text;
  for (int i = 0; i < 3600; ++i) text += fmt::format("{} {} 0\n", i % 60, i / 60);
  return text;
}

class FarPointsInFiles : public ::testing::Test {
 protected:
  std::string input(const std::string& name, const std::string& content) {
    write_text_file(directory_ / name, content);
    return directory_ / name;
  }

  Result<ConvertSummary> run(const std::vector<std::string>& inputs,
                             const ConvertOptions& options = {}) {
    Monitor monitor;
    ConvertOptions replacing = options;
    replacing.overwrite = true;
    return convert(inputs, directory_ / "out.las", replacing, monitor);
  }

  std::string refusal(const std::vector<std::string>& inputs, const ConvertOptions& options = {}) {
    const auto summary = run(inputs, options);
    EXPECT_FALSE(std::filesystem::exists(directory_ / "out.las"));
    if (summary) return "converted";
    EXPECT_EQ(summary.error().fault, Fault::kBadInput);
    return summary.error().message;
  }

  CloudHeader written() {
    const auto reader = open_reader(directory_ / "out.las");
    EXPECT_TRUE(reader);
    return (*reader)->header();
  }

  TemporaryDirectory directory_;
};

TEST_F(FarPointsInFiles, ATooCoarseScaleIsNeverChosen) {
  // 4 10^9 steps hold a side of 3 10^6 with a scale of 0.001, one of 10^8 with a scale of 0.1.
  const std::string near = input("near.xyz", unit_grid() + "0 0 3e6\n");
  const std::string far = input("far.xyz", unit_grid() + "0 0 1e8\n");

  const std::string message = refusal({far});

  EXPECT_NE(message.find("far.xyz: record 3600: z = 100000000 "), std::string::npos) << message;
  EXPECT_TRUE(run({near}));
}

TEST_F(FarPointsInFiles, TheNamedBoxLeavesTheFarPointOutAndCountsIt) {
  for (const char* far : {"1e9", "1e30", "3.4028234663852886e38", "-1e300"}) {
    std::filesystem::remove(directory_ / "out.las");
    const std::string scan =
        input("a.xyz", "nan 0 0\n" + unit_grid() + "0 " + std::string(far) + " 0\n");
    const std::vector<double> box = named_numbers(refusal({scan}), "--drop-outside");
    ASSERT_EQ(box.size(), 6u);
    ConvertOptions options;
    options.drop_outside = WorldBox{{box[0], box[1], box[2]}, {box[3], box[4], box[5]}};

    const auto summary = run({scan}, options);

    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_EQ(summary->points_in, 3602u);
    EXPECT_EQ(summary->points_out, 3600u);
    const std::map<std::string, std::uint64_t> dropped{
        {"position is not finite", 1}, {"position is outside the box of --drop-outside", 1}};
    EXPECT_EQ(summary->dropped, dropped);
    EXPECT_LE(written().grid->scale[1], 1e-3);
  }
}

TEST_F(FarPointsInFiles, LasRecordsOutsideTheBoxAreLeftOutWhole) {
  // Point i lies at (i, 1000 - i, 2000 + i / 100).
  const std::string scan = input("a.las", las({.format = 3, .points = 10}));
  ConvertOptions options;
  options.drop_outside = WorldBox{{2.5, 0, 0}, {6.5, 2000, 3000}};

  const auto summary = run({scan}, options);

  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->points_out, 4u);
  EXPECT_EQ(summary->dropped.begin()->second, 6u);
  const std::string before = read_text_file(scan);
  const std::string after = read_text_file(directory_ / "out.las");
  EXPECT_EQ(after.substr(227), before.substr(227 + 3 * kRecordSizes[3], 4 * kRecordSizes[3]));
  EXPECT_EQ(written().count, 4u);
  EXPECT_NEAR(written().bounds->max[0], 6, 1e-9);
}

TEST_F(FarPointsInFiles, AScaleThatCannotHoldThePointsIsRefusedWithOneThatDoes) {
  const std::string text = input("a.xyz", unit_grid());
  const std::string scan = input("a.las", las({.points = 3}));
  for (const std::string& file : {text, scan}) {
    std::filesystem::remove(directory_ / "out.las");
    ConvertOptions options;
    options.scale = World3{1e-12, 1e-12, 1e-12};

    const std::string message = refusal({file}, options);

    options.scale = triple(named_numbers(message, "--scale"));
    options.offset = triple(named_numbers(message, "--offset"));
    EXPECT_TRUE(run({file}, options)) << message;
  }
}

TEST_F(FarPointsInFiles, AnOffsetThatIsTooFarIsRefusedWithOneThatDoes) {
  const std::string scan = input("a.las", las({.points = 3}));
  ConvertOptions options;
  options.offset = World3{0, 1e12, 0};

  const std::string message = refusal({scan}, options);

  EXPECT_TRUE(named_numbers(message, "--scale").empty()) << message;
  options.offset = triple(named_numbers(message, "--offset"));
  EXPECT_TRUE(run({scan}, options)) << message;
  EXPECT_EQ(written().grid->scale, (World3{0.01, 0.01, 0.01}));
}

TEST_F(FarPointsInFiles, AScaleByHandThatMakesPointsOneIsTakenAndSaid) {
  const std::string text = input("a.xyz", unit_grid());
  ConvertOptions coarse, fine;
  coarse.scale = World3{10, 10, 10};
  fine.scale = World3{0.05, 0.05, 0.05};

  const auto coarse_summary = run({text}, coarse);
  const auto fine_summary = run({text}, fine);

  ASSERT_TRUE(coarse_summary && fine_summary);
  ASSERT_EQ(coarse_summary->notes.size(), 1u);
  EXPECT_NE(coarse_summary->notes[0].find("--scale 10"), std::string::npos);
  EXPECT_TRUE(fine_summary->notes.empty());
}

}  // namespace
}  // namespace pss::test
