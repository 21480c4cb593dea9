// Passes whose operators return any number of rows, columns alone, or look into another source.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "tests/stream/pass_fixture.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

constexpr std::size_t kCount = 30000;
constexpr double kRadius = 40;
const Lattice kUnit{{1, 1, 1}, {0, 0, 0}};

Schema id_schema() { return Schema({{"Id", Type::kUint32, 1, 1, 0, {}}}); }

Cloud numbered(std::size_t count, std::uint64_t seed) {
  Cloud cloud = random_cloud(count, 1000, sizeof(std::uint32_t), seed);
  for (std::uint32_t i = 0; i < count; ++i) std::memcpy(&cloud.rows[i * sizeof i], &i, sizeof i);
  return cloud;
}

Store store_of(const Cloud& cloud, const std::string& path, std::vector<std::size_t> cuts) {
  StoreHeader header;
  header.lattice = kUnit;
  header.schema = id_schema();
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  cuts.push_back(cloud.positions.size());
  for (std::size_t begin = 0; const std::size_t end : cuts) {
    expect_ok(append_tile(writer, header.schema, cloud, begin, end));
    begin = end;
  }
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

std::vector<std::byte> number(std::uint64_t value) {
  std::vector<std::byte> bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::uint64_t number(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  if (bytes.size() == sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

/// What the operators here have in common: a note that counts the points of a block.
class TestOperator : public Operator {
 public:
  explicit TestOperator(const Source& source) : header_(source.header()) {
    header_.ordered = false;
    needs_ = {source.schema().row_size(), {{0, 0, source.schema().row_size()}}, {}};
  }
  const StoreHeader& result_header() const override { return header_; }
  const PartNeeds& needs() const override { return needs_; }
  const Neighbourhood& neighbourhood() const override { return neighbourhood_; }
  std::uint64_t scratch_bytes(std::uint64_t) const override { return 0; }
  std::uint32_t note_version() const override { return 1; }
  void merge_note(std::vector<std::byte>& total, std::span<const std::byte> next) const override {
    total = number(number(total) + number(next));
  }

 protected:
  static void note_counts(const Part& part, Rows& rows) {
    for (const std::uint32_t count : part.block_counts) rows.notes.push_back(number(count));
  }
  StoreHeader header_;
  PartNeeds needs_;
  Neighbourhood neighbourhood_;
};

/// A point whose first coordinate is a multiple of three goes; one that is odd comes twice.
std::size_t copies_of(const Index3& p) { return p[0] % 3 == 0 ? 0 : p[0] % 2 != 0 ? 2 : 1; }

class Repeat : public TestOperator {
 public:
  using TestOperator::TestOperator;
  std::uint64_t most_rows(std::uint64_t own_points) const override { return 2 * own_points; }
  Rows apply(Part& part, Monitor&) const override {
    Rows rows;
    const std::size_t size = needs_.row_size;
    for (std::size_t i = 0; i < part.own.size(); ++i)
      for (std::size_t n = copies_of(part.own[i]); n > 0; --n) {
        rows.positions.push_back(part.own[i]);
        const auto row = part.rows.begin() + static_cast<std::ptrdiff_t>(i * size);
        rows.bytes.insert(rows.bytes.end(), row, row + static_cast<std::ptrdiff_t>(size));
      }
    note_counts(part, rows);
    return rows;
  }
};

/// A column with the number of neighbours within kRadius, the point itself among them.
class Count : public TestOperator {
 public:
  explicit Count(const Source& source) : TestOperator(source) {
    header_.schema = Schema({{"Around", Type::kUint32, 1, 1, 0, {}}});
    needs_ = {sizeof(std::uint32_t), {}, {}};
    neighbourhood_ = Neighbourhood::fixed(kRadius);
  }
  bool columns_alone() const override { return true; }
  Rows apply(Part& part, Monitor&) const override {
    Rows rows;
    rows.bytes.resize(part.own.size() * sizeof(std::uint32_t));
    Offsets offsets;
    for (std::size_t i = 0; i < part.own.size(); ++i) {
      part.grid->gather({part.own[i]}, kRadius, offsets);
      const auto count = static_cast<std::uint32_t>(offsets.size());
      std::memcpy(&rows.bytes[i * sizeof count], &count, sizeof count);
    }
    note_counts(part, rows);
    return rows;
  }
};

/// A column with the distance to the k-th nearest position; -1 beyond the cap.
class KthDistance : public TestOperator {
 public:
  KthDistance(const Source& source, int k, double cap) : TestOperator(source) {
    header_.schema = Schema({{"Distance", Type::kFloat64, 1, 1, 0, {}}});
    needs_ = {sizeof(double), {}, {}};
    neighbourhood_ = Neighbourhood::nearest({.k = k, .cap = cap, .first_guess = 5, .reach_at = {}});
  }
  bool columns_alone() const override { return true; }
  bool gathers_neighbours() const override { return false; }
  Rows apply(Part& part, Monitor&) const override {
    Rows rows;
    rows.bytes.resize(part.own.size() * sizeof(double));
    std::memcpy(rows.bytes.data(), part.kth_distances.data(), rows.bytes.size());
    note_counts(part, rows);
    return rows;
  }
};

/// The rows as they are, joined columns among them.
class Same : public TestOperator {
 public:
  explicit Same(const Source& source) : TestOperator(source) { header_.schema = source.schema(); }
  Rows apply(Part& part, Monitor&) const override {
    Rows rows{std::move(part.own), std::move(part.rows), {}};
    note_counts(part, rows);
    return rows;
  }
};

std::vector<std::uint32_t> block_counts(const Store& store) {
  std::vector<std::uint32_t> counts;
  for (std::size_t t = 0; t < store.tiles().size(); ++t)
    for (const BlockInfo& block : expect_value(store.read_index(t))) counts.push_back(block.count);
  return counts;
}

template <class T>
std::vector<T> values_of(const Cloud& cloud) {
  std::vector<T> values(cloud.rows.size() / sizeof(T));
  std::memcpy(values.data(), cloud.rows.data(), cloud.rows.size());
  return values;
}

Cloud repeated(const Cloud& cloud) {
  Cloud expected;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    for (std::size_t n = copies_of(cloud.positions[i]); n > 0; --n) {
      expected.positions.push_back(cloud.positions[i]);
      const auto row = cloud.rows.begin() + static_cast<std::ptrdiff_t>(4 * i);
      expected.rows.insert(expected.rows.end(), row, row + 4);
    }
  return expected;
}

std::vector<std::uint32_t> counted(const Cloud& queries, const Cloud& cloud) {
  const CellGrid grid(kUnit, cloud.positions, kRadius);
  std::vector<std::uint32_t> counts;
  Offsets offsets;
  for (const Index3& p : queries.positions) {
    grid.gather({p}, kRadius, offsets);
    counts.push_back(static_cast<std::uint32_t>(offsets.size()));
  }
  return counts;
}

class Passes : public testing::Test {
 protected:
  TemporaryDirectory folder_;
  Cloud cloud_ = numbered(kCount, 5);
  Store store_ = store_of(cloud_, folder_ / "s.pss", {9000, 9000, 20000});
  Source source_{store_};
};

TEST_F(Passes, KeepAnyNumberOfRowsOfEachTileInOrder) {
  const Store result = run(source_, Repeat(source_), folder_ / "r.pss");

  const Cloud found = expect_value(read_all(result));
  const Cloud expected = repeated(cloud_);
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.rows, expected.rows);
  ASSERT_EQ(result.tiles().size(), store_.tiles().size());
  EXPECT_EQ(result.tiles()[1].count, 0u);
  EXPECT_EQ(
      number(expect_value(merged_notes(Repeat(source_), result.tiles(), result.path())).bytes),
      kCount);
}

/// Reads notes of a version that Repeat does not write.
class Later : public Repeat {
 public:
  using Repeat::Repeat;
  std::uint32_t note_version() const override { return Repeat::note_version() + 1; }
};

TEST_F(Passes, MergeNotesOfTheirOwnVersionAlone) {
  const Store result = run(source_, Repeat(source_), folder_ / "r.pss");

  const auto refused = merged_notes(Later(source_), result.tiles(), result.path());

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().fault, Fault::kBadInput);
  EXPECT_NE(refused.error().message.find(result.path()), std::string::npos);
}

TEST_F(Passes, CutRowsIntoTheSameBlocksWhateverPartsTheMemoryAllows) {
  const Repeat op(source_);
  const Store whole = run(source_, op, folder_ / "whole.pss");

  const Store parts = run(source_, op, folder_ / "parts.pss", limit_leaving(700 << 10));

  EXPECT_EQ(block_counts(parts), block_counts(whole));
  EXPECT_EQ(bytes_of(folder_ / "parts.pss/segment-000000"),
            bytes_of(folder_ / "whole.pss/segment-000000"));
}

TEST_F(Passes, JoinColumnsAloneToTheRowsTheyWereComputedOf) {
  const Store counts = run(source_, Count(source_), folder_ / "c.pss");

  ASSERT_EQ(counts.points(), kCount);
  EXPECT_EQ(values_of<std::uint32_t>(expect_value(read_all(counts))), counted(cloud_, cloud_));
  EXPECT_LT(counts.bytes_on_disk(), kCount * 2) << "positions take next to nothing";
  Source joined(store_);
  expect_ok(joined.join(counts));
  ASSERT_EQ(joined.schema().fields().size(), 2u);
  const auto found = values_of<std::uint32_t>(
      expect_value(read_all(run(joined, Same(joined), folder_ / "j.pss"))));
  const std::vector<std::uint32_t> expected = counted(cloud_, cloud_);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(found[2 * i], i);
    ASSERT_EQ(found[2 * i + 1], expected[i]);
  }
}

TEST_F(Passes, RefuseColumnsOfOtherRows) {
  const Store other = store_of(cloud_, folder_ / "o.pss", {8000, 9000, 20000});
  const Store counts = run(Source(other), Count(Source(other)), folder_ / "c.pss");

  const Result<void> joined = source_.join(counts);

  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().fault, Fault::kBadInput);
}

TEST_F(Passes, RunOverSomeTilesAndJoinWhereTheyAre) {
  PassSources some(source_);
  some.tiles = {1, 3};

  const Store counts = run(some, Count(source_), folder_ / "c.pss");

  ASSERT_EQ(counts.tiles().size(), 2u);
  EXPECT_EQ(counts.tiles()[1].source, 3u);
  expect_ok(source_.join(counts));
  const BlockInfo last = expect_value(source_.read_index(3)).front();
  std::vector<std::byte> values(last.count * sizeof(std::uint32_t));
  expect_ok(source_.read_field(3, last, 1, values));
  std::uint32_t first = 0;
  std::memcpy(&first, values.data(), sizeof first);
  EXPECT_EQ(first, counted(cloud_, cloud_)[20000]);
  const BlockInfo none = expect_value(source_.read_index(0)).front();
  values.resize(none.count * sizeof(std::uint32_t));
  EXPECT_FALSE(source_.read_field(0, none, 1, values)) << "of a tile that the pass left out";
}

TEST_F(Passes, LookForNeighboursInAnotherSource) {
  const Cloud others = numbered(12000, 6);
  const Store other = store_of(others, folder_ / "o.pss", {500, 11000});
  const Source around(other);

  const Store counts = run({source_, around}, Count(source_), folder_ / "c.pss");

  EXPECT_EQ(values_of<std::uint32_t>(expect_value(read_all(counts))), counted(cloud_, others));
}

TEST_F(Passes, FindTheKthNearestWithinTheCapHoweverTilesAreCut) {
  constexpr int kK = 7;
  constexpr double kCap = 70;
  const CellGrid grid(kUnit, cloud_.positions, 50);

  const Store found = run(source_, KthDistance(source_, kK, kCap), folder_ / "k.pss");

  const auto distances = values_of<double>(expect_value(read_all(found)));
  std::size_t none = 0;
  for (std::size_t i = 0; i < kCount; i += 7) {
    const auto expected = grid.kth_distance(cloud_.positions[i], kK, kCap);
    ASSERT_EQ(distances[i], expected.value_or(-1)) << i;
    none += expected ? 0 : 1;
  }
  EXPECT_GT(none, 0u) << "the cap shall matter";
  EXPECT_LT(none, kCount / 7);
}

TEST_F(Passes, GoOnAfterTilesThatLeftNoRow) {
  const Repeat op(source_);
  const Store whole = run(source_, op, folder_ / "whole.pss");
  {
    StoreWriter begun = expect_value(StoreWriter::create(folder_ / "r.pss", op.result_header()));
    MemoryBudget budget(512 * kMiB, 1);
    Monitor monitor;
    PassSources first(source_);
    first.tiles = {0, 1};
    expect_value(run_operator(first, op, begun, budget, monitor));
  }

  MemoryBudget budget(512 * kMiB, 1);
  Monitor monitor;
  StoreWriter resumed = expect_value(StoreWriter::resume(folder_ / "r.pss", op.result_header()));
  const auto summary = expect_value(run_operator(source_, op, resumed, budget, monitor));
  expect_ok(resumed.finish("{}"));

  EXPECT_EQ(summary.resumed_tiles, 2u);
  EXPECT_EQ(summary.tiles, 2u);
  const Cloud found = expect_value(read_all(expect_value(Store::open(folder_ / "r.pss"))));
  EXPECT_EQ(found.rows, expect_value(read_all(whole)).rows);
}

}  // namespace
}  // namespace pss::test
