#include "io/formats/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace pss::test {
namespace {

TEST(FormatTable, HasRowsThatAreWhole) {
  for (const Format* format : kFormats) {
    EXPECT_FALSE(format->name.empty());
    EXPECT_FALSE(format->extensions.empty()) << format->name;
    EXPECT_FALSE(format->family.empty()) << format->name;
    EXPECT_TRUE(format->probe && format->open) << format->name;
    EXPECT_EQ(format->create == nullptr, format->plan == nullptr) << format->name;
    EXPECT_GE(format->bytes_factor, 1u) << format->name;
  }
}

TEST(FormatTable, HasEachNameAndExtensionOnce) {
  std::set<std::string_view> names, extensions;
  for (const Format* format : kFormats) {
    EXPECT_TRUE(names.insert(format->name).second) << format->name;
    EXPECT_EQ(find_format(format->name), format);
    for (const std::string_view extension : format->extensions) {
      EXPECT_TRUE(extensions.insert(extension).second) << extension;
      EXPECT_TRUE(std::ranges::none_of(extension, [](unsigned char c) { return std::isupper(c); }));
      EXPECT_EQ(format_by_extension("a." + std::string(extension)), format);
    }
  }
  EXPECT_EQ(find_format("nothing"), nullptr);
  EXPECT_EQ(format_by_extension("a.nothing"), nullptr);
}

TEST(FormatTable, TakesEachFamilyFromARow) {
  for (const Format* format : kFormats) {
    const Format* eldest = find_format(format->family);
    ASSERT_NE(eldest, nullptr) << format->name;
    EXPECT_EQ(eldest->family, eldest->name) << format->name;
  }
}

TEST(FormatTable, IsNamedInMessages) {
  for (const Format* format : kFormats) {
    EXPECT_NE(readable_formats().find(format->name), std::string::npos) << format->name;
    for (const std::string_view extension : format->extensions)
      EXPECT_EQ(writable_extensions().find(extension) != std::string::npos,
                format->create != nullptr)
          << extension;
    EXPECT_EQ(gridded_formats().find(format->name) != std::string::npos, format->integer_grid)
        << format->name;
  }
}

}  // namespace
}  // namespace pss::test
