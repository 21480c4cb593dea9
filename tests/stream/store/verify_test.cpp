#include "stream/store/verify.h"

#include <gtest/gtest.h>

#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_value;

class Verify : public testing::Test {
 protected:
  Verify() {
    test::write_cloud(folder_ / "a.las", test::sheet(5000, 1));
    whole_ =
        test::ingest_files(folder_, "s", {folder_ / "a.las"}, test::small_tiles(1000), 64 << 20)
            .verified;
  }

  Result<VerifySummary> verify(const std::string& path) {
    MemoryBudget budget = test::budget_of(64 << 20);
    Monitor monitor;
    return verify_store(path, budget, monitor);
  }

  test::TemporaryDirectory folder_;
  VerifySummary whole_;
};

TEST_F(Verify, CountsEverythingInASoundStore) {
  EXPECT_EQ(whole_.points, 5000u);
  EXPECT_TRUE(whole_.sound());
  EXPECT_GT(whole_.tiles, 4u);
  EXPECT_EQ(to_string(whole_.rows).size(), 32u);
}

TEST_F(Verify, HashesWhatXxh128DoesOfTheRowsWrittenOut) {
  const auto cloud = test::sorted(test::sheet(5000, 1));
  const std::size_t row = test::las_schema().row_size();
  StreamHash hash;
  for (std::size_t i = 0; i < 5000; ++i) {
    hash.update(std::as_bytes(std::span(cloud.positions[i])));
    hash.update(std::span(cloud.rows).subspan(i * row, row));
  }
  EXPECT_EQ(whole_.rows, hash.digest());
}

TEST_F(Verify, FindsAFlippedBitAnywhereAndGoesOn) {
  const std::string segment = segment_path(folder_ / "s.pss", 0);
  const std::size_t bits = 8 * test::bytes_of(segment).size();
  for (std::size_t bit = 5; bit < bits; bit += 8 * 301 + 1) {
    test::flip_bit(segment, bit);

    const auto found = expect_value(verify(folder_ / "s.pss"));

    ASSERT_FALSE(found.sound()) << bit;
    EXPECT_NE(found.damage.at(0).find(segment + ": damaged at offset"), std::string::npos);
    EXPECT_LT(found.points, 5000u);
    EXPECT_GT(found.points, 2000u);
    test::flip_bit(segment, bit);
  }
}

TEST_F(Verify, ListsAllDamageUpToABound) {
  const std::string segment = segment_path(folder_ / "s.pss", 0);
  auto bytes = test::bytes_of(segment);
  for (std::size_t i = 0; i < bytes.size(); i += 100) bytes[i] ^= std::byte{1};
  test::write_bytes(segment, bytes);

  const auto found = expect_value(verify(folder_ / "s.pss"));

  EXPECT_EQ(found.damage_count, found.tiles);
  EXPECT_EQ(found.damage.size(), std::min<std::size_t>(found.tiles, kMostDamage));
}

TEST_F(Verify, FindsNothingWrongWithEmptyTiles) {
  const Store store = expect_value(Store::open(folder_ / "s.pss"));
  auto writer = expect_value(StoreWriter::create(folder_ / "thin.pss", store.header()));
  const auto cloud = test::slice(test::sorted(test::sheet(5000, 1)), 0, 300);
  test::expect_ok(writer.commit_tile(cell_of(encode_key({-1, -1, -1}), 1), 0));
  test::expect_ok(writer.append(encode_block(test::las_schema(), cloud.positions, cloud.rows)));
  test::expect_ok(writer.commit_tile(cell_of(encode_key({0, 0, 0}), 1), 1));
  test::expect_ok(copy_inputs(store.path(), writer.path()));
  test::expect_ok(writer.finish("{}"));

  const auto found = expect_value(verify(folder_ / "thin.pss"));

  EXPECT_TRUE(found.sound());
  EXPECT_EQ(found.tiles, 2u);
  EXPECT_EQ(found.points, 300u);
}

TEST_F(Verify, FindsPointsOutOfOrderAndOutsideTheirCell) {
  const Store store = expect_value(Store::open(folder_ / "s.pss"));
  auto cloud = test::sheet(10, 1);  // as they come, in no order
  auto writer = expect_value(StoreWriter::create(folder_ / "bad.pss", store.header()));
  test::expect_ok(writer.append(encode_block(test::las_schema(), cloud.positions, cloud.rows)));
  test::expect_ok(writer.commit_tile(cell_of(encode_key(cloud.positions[0]), 30), 0));
  test::expect_ok(copy_inputs(store.path(), writer.path()));
  test::expect_ok(writer.finish("{}"));

  const auto found = expect_value(verify(folder_ / "bad.pss"));

  EXPECT_EQ(found.damage_count, 2u);
}

}  // namespace
}  // namespace pss
