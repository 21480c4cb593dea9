#include "stream/sort/octants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

struct Leaf {
  Cell cell;
  std::uint64_t count = 0;

  bool operator==(const Leaf&) const = default;
};

/// The octree by its definition: a cell with more than `most` points is split into eight.
void split(std::span<const Key> keys, const Cell& cell, std::size_t most,
           std::vector<Leaf>& leaves) {
  if (keys.empty()) return;
  if (keys.size() <= most) return leaves.push_back({cell, keys.size()});
  if (cell.level == kLatticeBits) {
    for (std::size_t i = 0; i < keys.size(); i += most)
      leaves.push_back({cell, std::min(most, keys.size() - i)});
    return;
  }
  while (!keys.empty()) {
    const Cell child = cell_of(keys[0], cell.level + 1);
    const auto end = std::ranges::upper_bound(keys, last_key(child));
    const auto count = static_cast<std::size_t>(end - keys.begin());
    split(keys.first(count), child, most, leaves);
    keys = keys.subspan(count);
  }
}

std::vector<Leaf> brute_force(const test::Cloud& cloud, std::size_t most) {
  std::vector<Key> keys;
  for (const Index3& p : cloud.positions) keys.push_back(encode_key(p));
  std::ranges::sort(keys);
  std::vector<Leaf> leaves;
  split(keys, Cell{}, most, leaves);
  return leaves;
}

void expect_tiles_are_leaves(const test::Cloud& cloud, std::uint32_t most) {
  test::TemporaryDirectory folder;
  test::write_cloud(folder / "a.las", cloud);

  const auto result =
      test::ingest_files(folder, "s", {folder / "a.las"}, test::small_tiles(most), 64 << 20);

  std::vector<Leaf> found;
  for (const TileInfo& tile : result.tiles) found.push_back({tile.cell, tile.count});
  EXPECT_EQ(found, brute_force(cloud, most));
}

TEST(Octants, AreTheLeavesOfTheOctree) {
  for (const std::uint32_t most : {1u, 2u, 7u, 100u, 5000u, 1u << 18})
    expect_tiles_are_leaves(test::sheet(most < 5 ? 300 : 20000, most), most);
}

TEST(Octants, ShareACellWhereMorePointsAreInOnePosition) {
  test::Cloud cloud = test::sheet(2000, 3);
  for (std::size_t i = 0; i < 1500; ++i) cloud.positions[i] = {777, 777, 7};
  for (const std::uint32_t most : {1u, 10u, 1499u, 1500u}) expect_tiles_are_leaves(cloud, most);
}

TEST(Octants, OfASinglePointAreTheWholeLattice) {
  EXPECT_EQ(leaf_level({5, 5}, nullptr, nullptr), 0);
}

TEST(Octants, KeepFarCornersApart) {
  const Key low = encode_key({kLatticeMin, kLatticeMin, kLatticeMin});
  const Key high = encode_key({kLatticeMax, kLatticeMax, kLatticeMax});
  EXPECT_EQ(leaf_level(low, nullptr, &high), 1);
  EXPECT_EQ(leaf_level(high, &low, nullptr), 1);
  EXPECT_EQ(leaf_level(low, nullptr, &low), kLatticeBits);
}

}  // namespace
}  // namespace pss
