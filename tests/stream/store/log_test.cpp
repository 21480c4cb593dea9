#include "stream/store/log.h"

#include <gtest/gtest.h>

#include "stream/sort/run_log.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

std::vector<std::byte> payload(std::size_t size, int seed) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 31 + seed);
  return bytes;
}

struct Seen {
  std::vector<std::uint32_t> types;
  std::vector<std::uint64_t> offsets;
  std::vector<std::vector<std::byte>> payloads;

  LogVisitor visitor() {
    return [this](const LogRecord& record) -> Result<void> {
      types.push_back(record.type);
      offsets.push_back(record.offset);
      payloads.emplace_back(record.payload.begin(), record.payload.end());
      return {};
    };
  }
};

/// Records 0..3 with payloads of 5, 0, 40 and 17 bytes; each durable before the next.
void write_log(const std::string& path) {
  LogWriter log = expect_value(LogWriter::create(path, 1, payload(5, 0)));
  for (const std::size_t size : {0u, 40u, 17u}) {
    expect_ok(log.append(2, payload(size, static_cast<int>(size))));
    expect_ok(log.sync());
  }
}

TEST(Log, GivesBackItsRecordsInOrder) {
  test::TemporaryDirectory folder;
  write_log(folder / "log");
  Seen seen;

  const auto size = expect_value(read_log(folder / "log", Tail::kWhole, seen.visitor()));

  EXPECT_EQ(size, test::bytes_of(folder / "log").size());
  EXPECT_EQ(seen.types, (std::vector<std::uint32_t>{1, 2, 2, 2}));
  EXPECT_EQ(seen.payloads[2], payload(40, 40));
}

TEST(Log, CutsATailTornAtAnyByteAndGoesOn) {
  test::TemporaryDirectory folder;
  write_log(folder / "log");
  const auto whole = test::bytes_of(folder / "log");
  Seen all;
  expect_value(read_log(folder / "log", Tail::kWhole, all.visitor()));
  for (std::size_t size = all.offsets[1]; size < whole.size(); ++size) {
    test::write_bytes(folder / "cut", std::span(whole).first(size));
    std::size_t expected = 0;
    for (std::size_t r = 0; r < 4; ++r)
      expected += all.offsets[r] + 32 + all.payloads[r].size() <= size ? 1 : 0;
    {
      Seen seen;
      LogWriter log = expect_value(LogWriter::open(folder / "cut", seen.visitor()));
      ASSERT_EQ(seen.types.size(), expected) << size;
      expect_ok(log.append(9, payload(3, 3)));
    }
    Seen again;
    expect_value(read_log(folder / "cut", Tail::kWhole, again.visitor()));
    ASSERT_EQ(again.types.size(), expected + 1) << size;
    EXPECT_EQ(again.types.back(), 9u);
  }
}

TEST(Log, TakesGarbageAfterTheLastDurableRecordAsATornTail) {
  test::TemporaryDirectory folder;
  {
    LogWriter log = expect_value(LogWriter::create(folder / "log", 1, payload(5, 0)));
    expect_ok(log.append(2, payload(10, 1)));
    expect_ok(log.append(3, payload(10, 2)));  // the two were never synced
  }
  auto bytes = test::bytes_of(folder / "log");
  bytes[bytes.size() - 42 - 42 + 3] ^=
      std::byte{1};  // the first of them is garbled, not the second
  test::write_bytes(folder / "log", bytes);
  Seen seen;

  expect_value(LogWriter::open(folder / "log", seen.visitor()));

  EXPECT_EQ(seen.types, std::vector<std::uint32_t>{1});
}

TEST(Log, TakesNoDamageOfItsFirstRecordForATornTail) {
  test::TemporaryDirectory folder;
  expect_value(LogWriter::create(folder / "log", 1, payload(5, 0)));
  const auto whole = test::bytes_of(folder / "log");
  for (std::size_t byte = 16; byte < whole.size(); ++byte) {
    auto bytes = whole;
    bytes[byte] ^= std::byte{4};
    test::write_bytes(folder / "log", bytes);
    Seen seen;

    const auto opened = LogWriter::open(folder / "log", seen.visitor());

    ASSERT_FALSE(opened) << byte;
    EXPECT_EQ(opened.error().fault, Fault::kBadInput);
  }
}

TEST(Log, NamesFileAndOffsetOfDamageInTheMiddle) {
  test::TemporaryDirectory folder;
  write_log(folder / "log");
  Seen all;
  expect_value(read_log(folder / "log", Tail::kWhole, all.visitor()));
  for (std::size_t bit = 0; bit < 8 * all.offsets[3]; ++bit) {
    test::flip_bit(folder / "log", bit);
    std::size_t record = 0;
    while (record < 3 && all.offsets[record + 1] <= bit / 8) ++record;
    const std::size_t expected = bit / 8 < 16 ? 0 : all.offsets[record];

    Seen seen;
    const auto found = read_log(folder / "log", Tail::kMayBeTorn, seen.visitor());

    ASSERT_FALSE(found.has_value()) << bit;
    EXPECT_EQ(found.error().fault, Fault::kBadInput);
    const std::string where = "offset " + std::to_string(expected) + ":";
    EXPECT_NE(found.error().message.find(where), std::string::npos) << found.error().message;
    EXPECT_NE(found.error().message.find(folder / "log"), std::string::npos);
    test::flip_bit(folder / "log", bit);
  }
}

TEST(Log, FindsEveryFlippedBitOfAFinishedLog) {
  test::TemporaryDirectory folder;
  write_log(folder / "log");
  const auto whole = test::bytes_of(folder / "log");
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    test::flip_bit(folder / "log", bit);
    Seen seen;
    EXPECT_FALSE(read_log(folder / "log", Tail::kWhole, seen.visitor()).has_value()) << bit;
    test::flip_bit(folder / "log", bit);
  }
}

TEST(RunLog, RefusesARunThatNoFileCanHold) {
  test::TemporaryDirectory folder;
  const RunInfo impossible{.id = 0, .points = 1, .blocks = std::uint64_t{1} << 61, .data_size = 0};
  expect_ok(expect_value(RunLog::open(folder / "runs", {})).add(impossible, {}, {}, {}));

  const auto again = RunLog::open(folder / "runs", {});

  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().fault, Fault::kBadInput);
}

}  // namespace
}  // namespace pss
