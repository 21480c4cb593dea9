#pragma once
// Where the tests find real scans, and where they may write.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pss::test {

/// The folder of real scans: PSS_TEST_DATA, or the one beside the checkout.
inline std::filesystem::path data_folder() {
  const char* named = std::getenv("PSS_TEST_DATA");
  return named ? named : PSS_SHARED_DATA;
}

/// Skips the test, visibly, where the real scans are missing.
#define PSS_REQUIRE_DATA()                                \
  if (!std::filesystem::exists(pss::test::data_folder())) \
  GTEST_SKIP() << "no test data at " << pss::test::data_folder()

/// A directory of this test's own, removed at its end.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "pss-test-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace pss::test
