#include "stream/store/segment_files.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <filesystem>
#include <random>
#include <thread>

#include "stream/limit/descriptors.h"
#include "stream/store/verify.h"
#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

std::size_t open_descriptors() {
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(open), end(open))) - 1;
}

/// The limit on descriptors, lowered for as long as it lives.
class DescriptorLimit {
 public:
  explicit DescriptorLimit(rlim_t limit) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit now{limit, before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &now), 0);
  }
  ~DescriptorLimit() { setrlimit(RLIMIT_NOFILE, &before_); }
  DescriptorLimit(const DescriptorLimit&) = delete;
  DescriptorLimit& operator=(const DescriptorLimit&) = delete;

 private:
  rlimit before_{};
};

/// Segments of 64 bytes, each byte its segment's number.
void write_segments(const test::TemporaryDirectory& folder, std::uint32_t count) {
  for (std::uint32_t n = 0; n < count; ++n)
    test::write_bytes(segment_path(folder.path().string(), n),
                      std::vector<std::byte>(64, static_cast<std::byte>(n)));
}

Result<void> expect_content(SegmentFiles& files, std::uint32_t segment) {
  std::array<std::byte, 3> bytes{};
  PSS_TRY(files.read(segment, 61, bytes));
  for (const std::byte b : bytes) EXPECT_EQ(b, static_cast<std::byte>(segment));
  return {};
}

TEST(SegmentFiles, KeepsOpenWhatWasReadLast) {
  test::TemporaryDirectory folder;
  write_segments(folder, 5);
  SegmentFiles files(folder.path().string(), 2);
  for (const std::uint32_t n : {0u, 1u, 0u, 2u}) expect_ok(expect_content(files, n));
  for (const std::uint32_t n : {0u, 1u, 2u})  // what is open can be read all the same
    expect_ok(remove_file(segment_path(folder.path().string(), n)));

  EXPECT_TRUE(expect_content(files, 0));
  EXPECT_TRUE(expect_content(files, 2));
  const auto closed = expect_content(files, 1);

  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().fault, Fault::kFailed);
  EXPECT_TRUE(expect_content(files, 4)) << "a failure takes no place";
}

TEST(SegmentFiles, AreReadByManyThreadsWithFewOpen) {
  test::TemporaryDirectory folder;
  write_segments(folder, 40);
  SegmentFiles files(folder.path().string(), 2);
  constexpr std::size_t kThreads = 6;
  const std::size_t before = open_descriptors();
  std::atomic<std::size_t> most = 0;
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      std::mt19937 random(static_cast<unsigned>(t));
      for (int i = 0; i < 400; ++i) {
        expect_ok(expect_content(files, static_cast<std::uint32_t>(random() % 40)));
        if (t == 0 && i % 20 == 0) most = std::max(most.load(), open_descriptors());
      }
    });
  for (std::thread& thread : threads) thread.join();

  // A read beyond the two opens its segment for itself; looking opens one more.
  EXPECT_LE(most, before + 2 + kThreads + 1);
  EXPECT_LE(open_descriptors(), before + 2);
}

TEST(SegmentFiles, TakeAShareOfTheDescriptorsThatThereAre) {
  std::size_t few = 0, many = 0;
  {
    const DescriptorLimit limit(40);
    EXPECT_EQ(descriptor_limit(), 40u);
    few = most_open_segments();
  }
  {
    const DescriptorLimit limit(1000);
    many = most_open_segments();
  }
  EXPECT_GE(few, 1u);
  EXPECT_LT(few, 20u);
  EXPECT_GE(many, 100u);
  EXPECT_LT(many, 500u);
}

TEST(Store, OfMoreSegmentsThanDescriptorsIsReadAndVerified) {
  test::TemporaryDirectory folder;
  constexpr std::size_t kTiles = 150;
  constexpr std::size_t kTilePoints = 20;
  const std::string path = folder / "s.pss";
  StoreHeader header;
  header.schema = test::rich_schema();
  header.ordered = false;
  const test::Cloud cloud =
      test::random_cloud(kTiles * kTilePoints, 1000, header.schema.row_size(), 3);
  StoreWriter writer = expect_value(StoreWriter::create(path, header, 1));
  for (std::size_t t = 0; t < kTiles; ++t)
    expect_ok(
        test::append_tile(writer, header.schema, cloud, t * kTilePoints, (t + 1) * kTilePoints));
  expect_ok(writer.finish("{}"));
  ASSERT_TRUE(exists(segment_path(path, kTiles - 1)));
  const DescriptorLimit limit(static_cast<rlim_t>(open_descriptors() + 25));
  MemoryBudget budget = test::budget_of(64 << 20);
  Monitor monitor;

  const Store store = expect_value(Store::open(path));
  const test::Cloud found = expect_value(test::read_all(store));
  const VerifySummary verified = expect_value(verify_store(path, budget, monitor));

  EXPECT_EQ(found.positions, cloud.positions);
  EXPECT_EQ(found.rows, cloud.rows);
  EXPECT_TRUE(verified.sound());
  EXPECT_EQ(verified.points, kTiles * kTilePoints);
  EXPECT_TRUE(check_bytes(path, monitor));
}

}  // namespace
}  // namespace pss
