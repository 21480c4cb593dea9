#include "io/formats/las/las_facts.h"

#include <gtest/gtest.h>

#include "io/formats/las/las_format.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

/// The facts of a file, as its row of the table gives them.
std::vector<Fact> facts_of(const LasFile& file, HeadBytes bytes) {
  const TemporaryDirectory directory;
  write_text_file(directory / "a.las", las(file));
  const auto reader = kLasFormat.open(bytes, directory / "a.las");
  EXPECT_TRUE(reader.has_value());
  return reader ? kLasFormat.facts((*reader)->header().carry) : std::vector<Fact>();
}

TEST(LasFacts, AreVersionRecordAndVlrs) {
  const LasFile file{.minor = 4,
                     .format = 6,
                     .extra = 2,
                     .vlrs = vlr("someone", 9, "four"),
                     .vlr_count = 1,
                     .evlrs = evlr("another", 10, "content"),
                     .evlr_count = 1};

  const std::vector<Fact> facts = facts_of(file, HeadBytes::kKept);

  ASSERT_EQ(facts.size(), 4u);
  EXPECT_EQ(facts[0].name, "las_version");
  EXPECT_EQ(std::get<std::string>(facts[0].value), "1.4");
  EXPECT_EQ(facts[1].name, "point_format");
  EXPECT_EQ(std::get<std::uint64_t>(facts[1].value), 6u);
  EXPECT_EQ(facts[2].name, "record_bytes");
  EXPECT_EQ(std::get<std::uint64_t>(facts[2].value), kRecordSizes[6] + 2);
  EXPECT_EQ(facts[3].name, "vlrs");
  const auto& vlrs = std::get<std::vector<FilePart>>(facts[3].value);
  ASSERT_EQ(vlrs.size(), 2u);
  EXPECT_EQ(vlrs[0].name, "someone");
  EXPECT_EQ(vlrs[0].type, "9");
  EXPECT_EQ(vlrs[0].bytes, 4u);
  EXPECT_EQ(vlrs[1].name, "another");
  EXPECT_EQ(vlrs[1].type, "10");
  EXPECT_EQ(vlrs[1].bytes, 7u);
}

TEST(LasFacts, AreNoneOfAHeadThatIsNotHeld) { EXPECT_TRUE(facts_of({}, HeadBytes::kLeft).empty()); }

}  // namespace
}  // namespace pss::test
