#pragma once
// LAS files made of bytes, opened by the reader.

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <string>

#include "io/formats/las/las_reader.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {

class LasReaderTest : public ::testing::Test {
 protected:
  Result<std::unique_ptr<Reader>> open(const std::string& content) {
    write_text_file(path_, content);
    return open_las(path_);
  }

  CloudHeader header_of(const std::string& content) {
    auto reader = open(content);
    EXPECT_TRUE(reader) << reader.error().message;
    return reader ? (*reader)->header() : CloudHeader{};
  }

  /// Expects a refusal that names the file and every one of `parts`.
  void expect_refused(const std::string& content, std::initializer_list<const char*> parts) {
    const auto reader = open(content);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().fault, Fault::kBadInput);
    const std::string& message = reader.error().message;
    EXPECT_NE(message.find(path_), std::string::npos) << message;
    for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "test.las";
};

}  // namespace pss::test
