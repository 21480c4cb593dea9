#include "io/file/line_source.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

LineSource open_lines(const std::string& path, const std::string& content) {
  write_text_file(path, content);
  auto bytes = ByteSource::open(path);
  EXPECT_TRUE(bytes.has_value());
  return LineSource(*std::move(bytes));
}

std::vector<std::string> all_lines(LineSource& lines) {
  std::vector<std::string> all;
  for (;;) {
    const auto line = lines.next();
    EXPECT_TRUE(line.has_value());
    if (!line || !*line) return all;
    all.emplace_back(**line);
  }
}

TEST(LineSource, EndsLinesInEveryWay) {
  const TemporaryDirectory directory;
  LineSource lines = open_lines(directory / "lines", "a\nb\r\nc\rd\r\r\n\ne");

  EXPECT_EQ(all_lines(lines), (std::vector<std::string>{"a", "b", "c", "d", "", "", "e"}));
}

TEST(LineSource, SplitsNoLineWhereverTheBufferEnds) {
  const TemporaryDirectory directory;
  std::mt19937 random(3);
  std::vector<std::string> expected;
  std::string content;
  while (content.size() < 1000000) {
    const std::size_t length = random() % 100 == 0 ? random() % 200000 : random() % 50;
    expected.emplace_back(length, static_cast<char>('a' + random() % 26));
    content += expected.back() + "\r\n";
  }
  LineSource lines = open_lines(directory / "lines", content);

  EXPECT_TRUE(all_lines(lines) == expected);
}

TEST(LineSource, ReturnsToAPlace) {
  const TemporaryDirectory directory;
  LineSource lines = open_lines(directory / "lines", "one\ntwo\nthree\n");
  ASSERT_EQ(*lines.next(), "one");
  const LinePlace place = lines.place();
  ASSERT_EQ(all_lines(lines).size(), 2u);

  lines.go_to(place);

  ASSERT_EQ(*lines.next(), "two");
  EXPECT_NE(lines.error("bad").message.find("lines: line 2 (offset 4): bad"), std::string::npos);
}

TEST(LineSource, RefusesALineWithoutEnd) {
  const TemporaryDirectory directory;
  LineSource lines = open_lines(directory / "lines", "a\n" + std::string(5000000, 'x'));
  ASSERT_TRUE(lines.next().has_value());

  const auto line = lines.next();

  ASSERT_FALSE(line.has_value());
  EXPECT_EQ(line.error().fault, Fault::kBadInput);
  EXPECT_NE(line.error().message.find("line 2"), std::string::npos);
}

}  // namespace
}  // namespace pss::test
