#pragma once
// Small input files, small memory limits, and what ingest must make of them by brute force.

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "io/formats/las/las_schema.h"
#include "io/open.h"
#include "stream/sort/ingest.h"
#include "stream/store/store.h"
#include "stream/store/verify.h"
#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss::test {

/// A limit that leaves `total` bytes for data.
inline MemoryBudget budget_of(std::uint64_t total) {
  const MemoryBudget none(std::uint64_t{1} << 40, 1);
  return MemoryBudget(none.limit() - none.total() + total, 1);
}

inline Schema las_schema() { return las_standard_schema(1); }
inline Lattice las_grid() { return {{0.01, 0.01, 0.01}, {500000, 4100000, 0}}; }

/// Points of a bumpy sheet with a dense corner, in random order; rows mostly alike.
inline Cloud sheet(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::size_t row = las_schema().row_size();
  Cloud cloud;
  cloud.rows.resize(count * row);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t side = i % 3 == 0 ? 500 : 20000;
    const auto x = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(side));
    const auto y = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(side));
    cloud.positions.push_back({x, y, x * y % 97});
    cloud.rows[i * row] = static_cast<std::byte>(random() % 3);
    cloud.rows[i * row + 8] = static_cast<std::byte>(random() % 2);
  }
  return cloud;
}

inline void write_cloud(const std::string& path, const Cloud& cloud,
                        const Lattice& grid = las_grid(), const Schema& schema = las_schema()) {
  WriteOptions options;
  options.schema = schema;
  options.grid = grid;
  options.scale = grid.scale;
  options.offset = grid.origin;
  options.count = cloud.positions.size();
  options.rules.overwrite = true;
  const auto writer = expect_value(create_writer(path, options));
  PointBatch batch;
  batch.index = cloud.positions;
  batch.rows = cloud.rows;
  if (batch.size() > 0) expect_ok(writer->write(batch));
  expect_ok(writer->finish());
}

inline void write_text(const std::string& path, const std::string& text) {
  write_bytes(path, std::as_bytes(std::span(text)));
}

/// The points [begin, end) of a cloud.
inline Cloud slice(const Cloud& cloud, std::size_t begin, std::size_t end) {
  const std::size_t row = cloud.rows.size() / std::max<std::size_t>(cloud.positions.size(), 1);
  const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  return {{cloud.positions.begin() + at(begin), cloud.positions.begin() + at(end)},
          {cloud.rows.begin() + at(begin * row), cloud.rows.begin() + at(end * row)}};
}

/// A cloud with its points in the order of `permutation`.
inline Cloud permuted(const Cloud& cloud, const std::vector<std::size_t>& permutation) {
  const std::size_t row = cloud.rows.size() / std::max<std::size_t>(cloud.positions.size(), 1);
  Cloud out;
  for (const std::size_t i : permutation) {
    out.positions.push_back(cloud.positions[i]);
    out.rows.insert(out.rows.end(), cloud.rows.begin() + static_cast<std::ptrdiff_t>(i * row),
                    cloud.rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * row));
  }
  return out;
}

inline Cloud shuffled(const Cloud& cloud, std::uint64_t seed) {
  std::vector<std::size_t> order(cloud.positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937_64 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  return permuted(cloud, order);
}

/// The cloud in the one order, by std::sort.
inline Cloud sorted(const Cloud& cloud) {
  const std::size_t row = cloud.rows.size() / std::max<std::size_t>(cloud.positions.size(), 1);
  std::vector<std::size_t> order(cloud.positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto bytes = [&](std::size_t i) { return std::span(cloud.rows).subspan(i * row, row); };
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    const Key x = encode_key(cloud.positions[a]);
    const Key y = encode_key(cloud.positions[b]);
    if (x != y) return x < y;
    return std::ranges::lexicographical_compare(bytes(a), bytes(b));
  });
  return permuted(cloud, order);
}

/// Says stop at its `stop_at`-th question, and ever after.
class StoppingMonitor : public Monitor {
 public:
  explicit StoppingMonitor(std::uint64_t stop_at) : stop_at_(stop_at) {}
  bool stopping() const override { return ++asked_ >= stop_at_; }
  std::uint64_t asked() const { return asked_; }

 private:
  std::uint64_t stop_at_;
  mutable std::atomic<std::uint64_t> asked_{0};
};

struct Ingested {
  IngestSummary summary;
  VerifySummary verified;
  std::vector<TileInfo> tiles;
  Cloud cloud;
};

/// Plans and ingests into folder/NAME.pss, then reads and verifies the store.
inline Ingested ingest_files(const TemporaryDirectory& folder, const std::string& name,
                             const std::vector<std::string>& inputs, const IngestOptions& options,
                             std::uint64_t total) {
  Monitor monitor;
  MemoryBudget budget = budget_of(total);
  const IngestPlan plan = expect_value(plan_ingest(inputs, options, monitor));
  const std::string store_path = folder / (name + ".pss");
  Ingested result;
  result.summary =
      expect_value(ingest(plan, store_path, folder / (name + ".work"), options, budget, monitor));
  EXPECT_EQ(budget.available(), budget.total());
  EXPECT_FALSE(exists(folder / (name + ".work/runs")));
  result.verified = expect_value(verify_store(store_path, budget, monitor));
  EXPECT_TRUE(result.verified.sound()) << result.verified.damage[0];
  EXPECT_TRUE(result.verified.complete);
  const Store store = expect_value(Store::open(store_path));
  result.tiles.assign(store.tiles().begin(), store.tiles().end());
  result.cloud = expect_value(read_all(store));
  return result;
}

inline IngestOptions small_tiles(std::uint32_t points) {
  IngestOptions options;
  options.tile_points = points;
  return options;
}

}  // namespace pss::test
