#include "stream/sort/disk_need.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "io/open.h"
#include "io/synth/synth.h"
#include "stream/sort/ingest_memory.h"
#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

/// Sums the runs at the moment when all of them are there and none is removed.
class RunSizes : public Monitor {
 public:
  explicit RunSizes(std::string folder) : folder_(std::move(folder)) {}
  void begin(std::string_view stage, std::uint64_t, std::uint64_t) override {
    if (stage != "merge") return;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      bytes += static_cast<double>(entry.file_size());
  }

  double bytes = 0;

 private:
  std::string folder_;
};

void write_scan(const std::string& path, const SynthOptions& options) {
  const auto reader = expect_value(SynthReader::create(options));
  WriteOptions to;
  to.schema = reader->header().schema;
  to.grid = reader->header().grid;
  to.scale = to.grid->scale;
  to.offset = to.grid->origin;
  to.count = options.points;
  const auto writer = expect_value(create_writer(path, to));
  PointBatch batch;
  do {
    expect_ok(reader->read(50000, batch));
    expect_ok(writer->write(batch));
  } while (batch.size() > 0);
  expect_ok(writer->finish());
}

struct Shares {
  double runs = 0;   ///< predicted over written
  double store = 0;  ///< predicted over written
};

/// Ingests half a million points, eight times what a run holds.
Shares predicted(SynthOptions scan, const IngestOptions& options = {}) {
  test::TemporaryDirectory folder;
  scan.points = 500000;
  scan.noise = 0.3;
  write_scan(folder / "a.las", scan);
  RunSizes monitor(folder / "work/runs");
  MemoryBudget budget = test::budget_of(24 << 20);
  const auto plan = expect_value(plan_ingest({folder / "a.las"}, options, monitor));
  const auto memory = expect_value(divide_memory(plan.header, plan.points, plan.unit, budget));

  const double bytes =
      expect_value(sample_bytes(plan, options.source_column, memory.chunk_points, monitor));

  expect_value(ingest(plan, folder / "s.pss", folder / "work", options, budget, monitor));
  const double all = bytes * static_cast<double>(plan.points);
  const Store store = expect_value(Store::open(folder / "s.pss"));
  return {all / monitor.bytes, all / static_cast<double>(store.bytes_on_disk())};
}

void expect_enough_and_not_much_more(const Shares& shares) {
  EXPECT_GE(shares.runs, 1);
  EXPECT_LE(shares.runs, 1.35);
  EXPECT_GE(shares.store, 1);
  EXPECT_LE(shares.store, 1.35);
}

TEST(DiskNeed, IsFoundForPointsInRandomOrder) { expect_enough_and_not_much_more(predicted({})); }

TEST(DiskNeed, IsFoundForPointsAlongAFront) {
  SynthOptions scan;
  scan.order = SynthOrder::kSweep;
  expect_enough_and_not_much_more(predicted(scan));
}

TEST(DiskNeed, IsFoundWhereScansOverlapAndTheirTimesMix) {
  SynthOptions scan;
  scan.order = SynthOrder::kSweep;
  scan.scans = 4;
  expect_enough_and_not_much_more(predicted(scan));
}

TEST(DiskNeed, IsFoundForFewAttributes) {
  SynthOptions scan;
  scan.time = false;
  expect_enough_and_not_much_more(predicted(scan));
}

TEST(DiskNeed, CountsTheSourceColumn) {
  IngestOptions options;
  options.source_column = true;
  expect_enough_and_not_much_more(predicted({}, options));
}

}  // namespace
}  // namespace pss
