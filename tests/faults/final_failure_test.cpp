// A failed write or sync is final: the next sync may succeed although the bytes are gone.

#include <gtest/gtest.h>

#include <cerrno>

#include "stream/store/log.h"
#include "stream/store/store.h"
#include "stream/store/store_writer.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/simulated_disk.h"

namespace pss::test {
namespace {

/// The n-th call of one kind from now on fails with EIO; no other does.
void fail_once(SimulatedDisk& disk, Call kind, int n = 1) {
  disk.set_fault([=, seen = 0](Call call, const std::string&) mutable {
    return call == kind && ++seen == n ? EIO : 0;
  });
}

class FinalFailure : public testing::TestWithParam<Call> {};

TEST_P(FinalFailure, OfALogStopsAllLaterRecords) {
  SimulatedDisk disk;
  LogWriter log = expect_value(LogWriter::create("/log", 1, {}));
  fail_once(disk, GetParam());
  const auto write = [&]() -> Result<void> {
    PSS_TRY(log.append(2, {}));
    return log.sync();
  };
  const auto first = write();
  const auto calls = disk.calls_made();

  const auto second = write();
  const auto third = log.sync();

  ASSERT_FALSE(first);
  ASSERT_FALSE(second);
  ASSERT_FALSE(third);
  EXPECT_EQ(second.error().message, first.error().message);
  EXPECT_EQ(third.error().message, first.error().message);
  EXPECT_EQ(disk.calls_made(), calls);
}

TEST_P(FinalFailure, OfAStoreStopsAllLaterTilesAndTheEnd) {
  for (const int n : {1, 2}) {  // of the segment, of the manifest
    SimulatedDisk disk;
    StoreHeader header;
    header.schema = rich_schema();
    const Cloud cloud = random_cloud(20, 1000, header.schema.row_size(), 5);
    StoreWriter writer = expect_value(StoreWriter::create("/s.pss", header));
    expect_ok(append_tile(writer, header.schema, cloud, 0, 10));
    fail_once(disk, GetParam(), n);
    const auto first = append_tile(writer, header.schema, cloud, 10, 20);
    const auto calls = disk.calls_made();

    const auto sync = writer.sync();
    const auto finish = writer.finish("{}");

    ASSERT_FALSE(first);
    ASSERT_FALSE(sync);
    ASSERT_FALSE(finish);
    EXPECT_EQ(sync.error().message, first.error().message);
    EXPECT_EQ(finish.error().message, first.error().message);
    EXPECT_EQ(disk.calls_made(), calls);
  }
}

INSTANTIATE_TEST_SUITE_P(Calls, FinalFailure, testing::Values(Call::kWrite, Call::kSync),
                         [](const auto& param) {
                           return std::string(param.param == Call::kWrite ? "Write" : "Sync");
                         });

}  // namespace
}  // namespace pss::test
