#include "io/synth/synth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "tests/io/synth/synth_fixture.h"

namespace pss::test {
namespace {

TEST(SynthReader, GivesTheSameBytesHoweverTheRecordsAreSplit) {
  const SynthOptions options = rich_options();
  const PointBatch whole = read_all(options);
  auto reader = SynthReader::create(options);
  std::vector<Index3> index;
  std::vector<std::byte> rows;
  std::size_t max = 1;
  for (PointBatch batch; (*reader)->read(max, batch) && batch.size() > 0; max = max * 5 % 4099) {
    EXPECT_EQ(batch.first_record, index.size());
    index.insert(index.end(), batch.index.begin(), batch.index.end());
    rows.insert(rows.end(), batch.rows.begin(), batch.rows.end());
  }

  EXPECT_EQ(index, whole.index);
  EXPECT_EQ(rows, whole.rows);
}

TEST(SynthReader, GivesTheSameBytesOnOneThreadAsOnTwo) {
  const SynthOptions options = rich_options();
  PointBatch one, two;
  {
    ThreadLimit limit(1);
    one = read_all(options);
  }
  {
    ThreadLimit limit(2);
    two = read_all(options);
  }

  EXPECT_EQ(one.index, two.index);
  EXPECT_EQ(one.rows, two.rows);
}

TEST(SynthReader, ReadsAnyRecordOfTenThousandMillion) {
  SynthOptions options = options_for(Terrain(), 10'000'000'000);
  options.scans = 7;
  const std::uint64_t first = 9'999'999'000;

  const PointBatch end = read_range(options, first, 2000);
  const PointBatch part = read_range(options, first + 333, 10);

  ASSERT_EQ(end.size(), 1000u);
  EXPECT_TRUE(std::equal(part.index.begin(), part.index.end(), end.index.begin() + 333));
  for (const Index3& index : end.index)
    for (const std::int64_t steps : index) EXPECT_LT(std::abs(steps), std::int64_t{1} << 31);
}

TEST(SynthReader, FillsTheAttributesOfARecord) {
  SynthOptions options = options_for(Sphere{2}, 1001);
  options.scans = 3;
  auto reader = SynthReader::create(options);
  const Schema& schema = (*reader)->header().schema;
  PointBatch batch;
  ASSERT_TRUE((*reader)->read(2000, batch));
  const auto value = [&](const char* name, std::size_t record) {
    return read_value(*schema.dimension(name), &batch.rows[record * schema.row_size()]);
  };

  EXPECT_EQ((*reader)->header().count, 1001u);
  EXPECT_EQ(value("PointSourceId", 0), 1);
  EXPECT_EQ(value("PointSourceId", 333), 1);
  EXPECT_EQ(value("PointSourceId", 334), 2);
  EXPECT_EQ(value("PointSourceId", 1000), 3);
  EXPECT_EQ(value("ReturnNumber", 500), 1);
  EXPECT_EQ(value("Classification", 500), 1);
  for (std::size_t i = 1; i < 1001; ++i) EXPECT_GT(value("GpsTime", i), value("GpsTime", i - 1));
}

TEST(SynthReader, LeavesTimeOutAndNothingElseWhenAsked) {
  SynthOptions options = rich_options();
  const PointBatch timed = read_all(options);
  const std::size_t row = SynthReader::create(options).value()->header().schema.row_size();
  options.time = false;
  const PointBatch bare = read_all(options);

  EXPECT_EQ(bare.index, timed.index);
  ASSERT_EQ(bare.rows.size(), timed.rows.size() - 8 * bare.size());
  constexpr std::size_t kBeforeTime = 8;
  for (std::size_t i = 0; i < bare.size(); ++i) {
    const auto with = timed.rows.begin() + static_cast<std::ptrdiff_t>(i * row);
    const auto without = bare.rows.begin() + static_cast<std::ptrdiff_t>(i * (row - 8));
    ASSERT_TRUE(std::equal(without, without + kBeforeTime, with));
    ASSERT_TRUE(std::equal(without + kBeforeTime, without + static_cast<std::ptrdiff_t>(row - 8),
                           with + kBeforeTime + 8));
  }
}

TEST(SynthReader, ALargeOffsetChangesNoLatticePosition) {
  SynthOptions options = options_for(Terrain(), 3000);
  options.noise = 0.1;
  const PointBatch near = read_all(options);
  options.offset = {500000, 4649776, 100};
  const PointBatch far = read_all(options);

  EXPECT_EQ(near.index, far.index);
  EXPECT_EQ(grid(options).origin, options.offset);
}

TEST(SynthReader, AnotherSeedMovesEveryPoint) {
  SynthOptions options = options_for(Torus{}, 1000);
  const PointBatch one = read_all(options);
  options.seed = 2;
  const PointBatch two = read_all(options);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_NE(one.index[i], two.index[i]);
}

TEST(SynthReader, ScattersRecordsUnlessToldToSweep) {
  SynthOptions options = options_for(Plane{100, 100}, 10'000);
  const auto mean_step = [](const std::vector<World3>& points) {
    double sum = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      sum += std::abs(points[i][0] - points[i - 1][0]);
    return sum / static_cast<double>(points.size());
  };
  const double scattered = mean_step(places(options));
  options.order = SynthOrder::kSweep;
  const double sweeping = mean_step(places(options));

  EXPECT_GT(scattered, 20);
  EXPECT_LT(sweeping, 0.5);
}

TEST(SynthReader, PointsStayWithinTheHeadersBounds) {
  const SynthOptions options = rich_options();
  auto reader = SynthReader::create(options);
  const WorldBox box = *(*reader)->header().bounds;
  for (const Index3& index : read_all(options).index) {
    const World3 p = to_world(grid(options), index);
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_GE(p[a], box.min[a]);
      ASSERT_LE(p[a], box.max[a]);
    }
  }
}

TEST(SynthReader, MakesTinyScansOfEveryCount) {
  for (std::uint64_t points = 0; points < 20; ++points) {
    SynthOptions options = rich_options();
    options.points = points;
    EXPECT_EQ(read_range(options, 0, 100).size(), points);
  }
}

TEST(SynthOptions, RefusesWhatMakesNoSense) {
  const auto refused = [](auto change) {
    SynthOptions options;
    change(options);
    const auto reader = SynthReader::create(options);
    return !reader && reader.error().fault == Fault::kUsage;
  };
  EXPECT_TRUE(refused([](SynthOptions& o) { o.scans = 0; }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.noise = -1; }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.noise = std::nan(""); }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.jitter = -0.1; }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.corner_density = 0; }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.density_gradient = 0.5; }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.scale = 1e-14; }));
  EXPECT_TRUE(refused([](SynthOptions& o) { o.offset[1] = INFINITY; }));
  EXPECT_FALSE(refused([](SynthOptions&) {}));
}

TEST(SynthOptions, TheScaleIsAPowerOfTenBelowAThousandthOfTheSpacing) {
  EXPECT_EQ(default_scale(0.0089), 1e-6);
  EXPECT_EQ(default_scale(1), 1e-3);
  EXPECT_EQ(default_scale(0.999), 1e-4);
  EXPECT_EQ(default_scale(54321), 10);
}

TEST(MakeSurface, TakesSizesOrTheirDefaults) {
  EXPECT_EQ(std::get<Torus>(*make_surface("torus", {})).minor, 0.4);
  EXPECT_EQ(std::get<Torus>(*make_surface("torus", {5, 2})).minor, 2);
  EXPECT_EQ(std::get<Sphere>(*make_surface("sphere", {3})).radius, 3);
  EXPECT_EQ(std::get<Plane>(*make_surface("plane", {3, 4, -0.5})).slope_x, -0.5);
  EXPECT_EQ(std::get<Terrain>(*make_surface("terrain", {3})).depth(), 1000);
  EXPECT_FALSE(make_surface("cube", {}));
  EXPECT_FALSE(make_surface("torus", {1, 1}));
  EXPECT_FALSE(make_surface("sphere", {-1}));
  EXPECT_FALSE(make_surface("sphere", {1, 2}));
}

TEST(ParametersJson, SaysWhatTheSurfaceIs) {
  SynthOptions options = options_for(Sphere{2}, 10'000);
  options.noise = 0.5;
  const std::string json = parameters_json(options);

  EXPECT_NE(json.find("\"shape\": \"sphere\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"radius\": 2.0"), std::string::npos) << json;
  // sqrt(4 pi 4 / 10^4) = 0.0709, half of it 0.0354
  EXPECT_NE(json.find("\"spacing\": 0.0708981"), std::string::npos) << json;
  EXPECT_NE(json.find("\"sigma\": 0.0354490"), std::string::npos) << json;
}

}  // namespace
}  // namespace pss::test
