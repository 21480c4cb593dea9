#include "io/file/fingerprint.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

TEST(Fingerprint, SeesEveryEndOfAFile) {
  TemporaryDirectory folder;
  const std::string path = folder / "f";
  std::string text(200000, 'x');
  write_text_file(path, text);
  const auto before = fingerprint(path);

  text.front() = 'y';
  write_text_file(path, text);
  const auto head = fingerprint(path);
  text.front() = 'x';
  text.back() = 'y';
  write_text_file(path, text);
  const auto tail = fingerprint(path);

  ASSERT_TRUE(before && head && tail);
  EXPECT_EQ(before->size, 200000u);
  EXPECT_NE(head->content_hash, before->content_hash);
  EXPECT_NE(tail->content_hash, before->content_hash);
}

}  // namespace
}  // namespace pss::test
