#include "stream/jobs/finished.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "io/file/file.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;

const FinishedOutput kFinished{"identity", {5, 6, {7, 8}}};

TEST(Finished, OutputsAreRememberedByTheirRealPath) {
  test::TemporaryDirectory folder;
  std::ofstream(folder / "out.las") << "x";
  std::filesystem::create_symlink("out.las", folder.path() / "link.las");

  expect_ok(remember_finished(folder / "state/pss", folder / "out.las", kFinished));

  const auto found = recall_finished(folder / "state/pss", folder / "link.las");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->identity, "identity");
  EXPECT_TRUE(same_bytes(found->content, kFinished.content));
  EXPECT_EQ(found->content.modified_ns, 6);
  EXPECT_FALSE(recall_finished(folder / "state/pss", folder / "other.las"));
}

TEST(Finished, OutputsAreNotKnownByADamagedRecord) {
  test::TemporaryDirectory folder;
  const std::string state = folder / "state";
  expect_ok(remember_finished(state, folder / "out.las", kFinished));
  const std::string record = std::filesystem::directory_iterator(state)->path().string();
  const auto size = std::filesystem::file_size(record);
  for (std::uintmax_t at = 0; at < size; ++at) {
    std::fstream file(record, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(at));
    const auto byte = static_cast<char>(file.get());
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(byte ^ 1)).flush();
    const auto found = recall_finished(state, folder / "out.las");
    EXPECT_TRUE(!found || same_bytes(found->content, kFinished.content)) << at;
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
  }
}

TEST(Finished, NothingIsRememberedWithoutAFolder) {
  EXPECT_TRUE(remember_finished("", "out.las", kFinished));
  EXPECT_FALSE(recall_finished("", "out.las"));
}

}  // namespace
}  // namespace pss
