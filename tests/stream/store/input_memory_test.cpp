#include "stream/store/input_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "stream/sort/ingest_memory.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/stream/ingest_fixture.h"
#include "tests/stream/store_fixture.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

constexpr std::uint64_t kMiB = 1 << 20;

/// A LAS file whose head is `vlrs` VLRs of 60000 bytes.
std::string scan(const test::TemporaryDirectory& folder, std::uint32_t vlrs) {
  test::LasFile file{.points = 3, .vlr_count = vlrs};
  for (std::uint32_t i = 0; i < vlrs; ++i)
    file.vlrs += test::vlr("someone", 1, std::string(60000, 'a'));
  const std::string path = folder / ("scan" + std::to_string(vlrs) + ".las");
  test::write_text(path, test::las(file));
  return path;
}

LeastMemory work(std::uint64_t bytes) {
  return [bytes](const StoreHeader&, std::uint64_t, std::size_t) { return bytes; };
}

/// The limit, in bytes, that a refusal names.
std::uint64_t named(const Error& error) {
  const std::string before = "--memory-limit ";
  const std::size_t at = error.message.find(before);
  EXPECT_NE(at, std::string::npos) << error.message;
  return std::stoull(error.message.substr(at + before.size())) * kMiB;
}

TEST(InputMemory, IsThreeTimesTheHeadOfTheFirstInputAndItsNames) {
  test::TemporaryDirectory folder;
  MemoryBudget budget(128 * kMiB, 2);

  const auto one = expect_value(reserve_inputs({scan(folder, 20)}, work(0), budget));
  const auto two = expect_value(reserve_inputs({scan(folder, 20), "other"}, work(0), budget));

  EXPECT_GE(one.bytes(), 3u * 20 * 60054);
  EXPECT_LT(one.bytes(), 3u * 20 * 60054 + 5000);
  EXPECT_LT(two.bytes(), one.bytes() + 2000);
  EXPECT_EQ(budget.available(), budget.total() - one.bytes() - two.bytes());
}

TEST(InputMemory, OfManyNamesOrALargeHeadIsRefusedWithALimitThatDoes) {
  test::TemporaryDirectory folder;
  const std::uint64_t least = 30 * kMiB;
  for (const auto& inputs : {std::vector<std::string>{scan(folder, 300)},
                             std::vector<std::string>(100000, scan(folder, 1))}) {
    MemoryBudget budget(96 * kMiB, 2);

    const auto refused = reserve_inputs(inputs, work(least), budget);

    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::kMemoryLimit);
    EXPECT_NE(refused.error().message.find(std::to_string(inputs.size()) + " inputs"),
              std::string::npos);
    EXPECT_EQ(budget.available(), budget.total());
    MemoryBudget larger(named(refused.error()), 2);
    const auto held = expect_value(reserve_inputs(inputs, work(least), larger));
    EXPECT_GE(larger.available(), least);
  }
}

TEST(InputMemory, OfAStoreIsKnownBeforeItsHeaderIsRead) {
  test::TemporaryDirectory folder;
  StoreHeader header;
  header.schema = test::rich_schema();
  const std::vector<InputRecord> inputs = {{"a.las", 5, 6, 7}};
  header.inputs = digest_of(inputs);
  const std::string path = folder / "s.pss";
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  expect_ok(test::write_inputs(path, inputs, {"LAS", std::vector<std::byte>(20 * kMiB), {}}));
  expect_ok(writer.finish("{}"));
  MemoryBudget small(96 * kMiB, 2);
  MemoryBudget large(512 * kMiB, 2);

  const auto refused = reserve_header_and_head(path, small);
  const auto held = expect_value(reserve_header_and_head(path, large));

  ASSERT_FALSE(refused);
  EXPECT_GE(held.bytes(), 3 * (encode_header(header).size() + 20 * kMiB));
  EXPECT_GE(held.bytes(), memory_of(header));
  MemoryBudget named_budget(named(refused.error()), 2);
  EXPECT_TRUE(reserve_header_and_head(path, named_budget).has_value());
  EXPECT_LT(expect_value(reserve_header(path, small)).bytes(), kMiB) << "who reads no head";
}

TEST(MemoryBudget, NamesALimitUnderWhichWhatItRefusedFits) {
  for (const std::uint64_t bytes : {100 * kMiB, 100 * kMiB + 1, 1000 * kMiB - 1}) {
    MemoryBudget budget(96 * kMiB, 2);
    const Reservation held = expect_value(budget.take(7 * kMiB + 3, "something"));

    const auto refused = budget.take(bytes, "more");

    ASSERT_FALSE(refused);
    MemoryBudget larger(named(refused.error()), 2);
    const Reservation again = expect_value(larger.take(held.bytes(), "something"));
    EXPECT_TRUE(larger.take(bytes, "more").has_value()) << bytes;
  }
}

/// Asks for the least, and a little more or less, of rows of so many bytes.
void expect_least(std::uint32_t row, std::uint64_t points, std::size_t unit) {
  StoreHeader header;
  if (row > 0) header.schema.add({"bytes", Type::kUint8, row, 1, 0, {}});
  const std::uint64_t least = least_ingest_memory(header, points, unit);
  for (const std::uint64_t more : {std::uint64_t{0}, std::uint64_t{1}, least / 7, least}) {
    const auto memory = divide_memory(header, points, unit, test::budget_of(least + more));
    ASSERT_TRUE(memory.has_value()) << memory.error().message;
    EXPECT_GE(memory->fan_in, 2u);
    EXPECT_GE(memory->batches.count, 1u);
    EXPECT_EQ(memory->batches.points % unit, 0u);
    EXPECT_GT(memory->chunk_points, memory->batches.points);
    EXPECT_LE(memory->read_bytes, least + more);
  }
  const auto refused = divide_memory(header, points, unit, test::budget_of(least - 1));
  ASSERT_FALSE(refused.has_value());
  EXPECT_GE(named(refused.error()), test::budget_of(least).limit());
}

TEST(IngestMemory, SucceedsWithWhatItSaysIsTheLeastWhateverTheRowsPointsAndUnits) {
  for (const std::uint32_t row : {0u, 8u, 300u, 4000u, 65000u})
    for (const std::uint64_t points : {0ul, 100ul, 300000ul, 2000000000ul})
      for (const std::size_t unit : {1u, 64u, 65u, 8000u, 50000u, 20000000u}) {
        SCOPED_TRACE(std::to_string(row) + " " + std::to_string(points) + " " +
                     std::to_string(unit));
        expect_least(row, points, unit);
      }
}

TEST(StoreHeader, IsComparedWithItsBytesAsTheyLie) {
  StoreHeader header;
  header.schema = test::rich_schema();
  const std::vector<InputRecord> inputs = {{"a.las", 5, 6, 7}};
  header.inputs = digest_of(inputs);
  header.parameters = "{}";
  std::vector<std::byte> bytes = encode_header(header);
  EXPECT_TRUE(is_encoded(header, bytes));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= std::byte{1};
    EXPECT_FALSE(is_encoded(header, bytes)) << i;
    bytes[i] ^= std::byte{1};
    EXPECT_FALSE(is_encoded(header, std::span(bytes).first(i))) << i;
  }
  bytes.push_back({});
  EXPECT_FALSE(is_encoded(header, bytes));
}

}  // namespace
}  // namespace pss
