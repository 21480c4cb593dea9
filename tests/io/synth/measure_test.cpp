#include "io/synth/measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "core/parallel.h"
#include "core/status.h"
#include "io/synth/synth.h"

namespace pss::test {
namespace {

/// Points in memory as a file without a grid.
class MemoryReader : public Reader {
 public:
  MemoryReader(Schema schema, PointBatch points) : points_(std::move(points)) {
    header_.schema = std::move(schema);
  }
  const CloudHeader& header() const override { return header_; }
  Result<void> read(std::size_t max, PointBatch& batch) override {
    batch.clear();
    const std::size_t end = std::min(points_.size(), next_ + max);
    const std::size_t row = header_.schema.row_size();
    for (; next_ < end; ++next_) {
      batch.world.push_back(points_.world[next_]);
      const auto* from = points_.rows.data() + next_ * row;
      batch.rows.insert(batch.rows.end(), from, from + row);
    }
    return {};
  }
  Result<void> seek(std::uint64_t record) override {
    next_ = static_cast<std::size_t>(record);
    return {};
  }

 private:
  CloudHeader header_;
  PointBatch points_;
  std::size_t next_ = 0;
};

Measurement measured(Reader& reader, const SynthOptions& truth) {
  Monitor silent;
  auto result = measure(reader, truth, silent);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

SynthOptions sphere_at(const World3& offset) {
  SynthOptions truth;
  truth.surface = Sphere{2};
  truth.offset = offset;
  return truth;
}

TEST(Measure, FindsTheNoiseOfASynthesisedScan) {
  SynthOptions options;
  options.points = 100'000;
  options.noise = 0.2;
  options.offset = {500000, 4649776, 100};
  auto reader = SynthReader::create(options);
  const double sigma = 0.2 * spacing(options);

  const Measurement found = measured(**reader, options);

  EXPECT_EQ(found.distance.count(), 100'000u);
  // The standard errors are 1/sqrt(2n) = 0.22 %, and for percentiles 0.5 %, with bins of 0.8 %.
  EXPECT_NEAR(found.distance.rms() / sigma, 1, 0.01);
  EXPECT_NEAR(found.distance.mean() / sigma, 0, 0.015);
  EXPECT_NEAR(found.distance.percentile(0.5) / sigma, 0.6745, 0.015);
  EXPECT_NEAR(found.distance.percentile(0.95) / sigma, 1.960, 0.03);
  EXPECT_NEAR(found.distance.percentile(0.99) / sigma, 2.576, 0.05);
  EXPECT_FALSE(found.normal);
}

TEST(Measure, GivesTheSameNumbersOnEveryThreadCount) {
  SynthOptions options;
  options.surface = Terrain();
  options.points = 30'000;
  options.noise = 0.2;
  std::vector<std::string> reports;
  for (const int threads : {1, 2}) {
    ThreadLimit limit(threads);
    auto reader = SynthReader::create(options);
    reports.push_back(measurement_json(measured(**reader, options), options));
  }

  EXPECT_EQ(reports[0], reports[1]);
}

TEST(Measure, TakesDistancesFromTheOffset) {
  PointBatch points;
  points.world = {{13, 20, 30}, {10, 21.5, 30}, {10, 20, 28}};
  MemoryReader reader(Schema{}, points);

  const Measurement found = measured(reader, sphere_at({10, 20, 30}));

  EXPECT_DOUBLE_EQ(found.distance.mean(), (1 - 0.5 + 0) / 3);
  EXPECT_DOUBLE_EQ(found.distance.rms(), std::sqrt((1 + 0.25) / 3));
  EXPECT_DOUBLE_EQ(found.distance.max(), 1);
}

TEST(Measure, CountsPointsThatHaveNoPlace) {
  PointBatch points;
  const double infinity = std::numeric_limits<double>::infinity();
  points.world = {{3, 0, 0}, {std::nan(""), 0, 0}, {0, infinity, 0}, {1e200, 1e200, 1e200}};
  MemoryReader reader(Schema{}, points);

  const Measurement found = measured(reader, sphere_at({0, 0, 0}));

  EXPECT_EQ(found.distance.count(), 1u);
  EXPECT_EQ(found.not_finite, 3u);
}

/// Six points on a sphere of radius 2 with the attributes that smooth gives.
class DescribedSphere {
 public:
  DescribedSphere() {
    for (const char* name : {"NormalX", "NormalY", "NormalZ", "MeanCurvature", "GaussianCurvature"})
      schema_.add({name, Type::kFloat32, 1, 1, 0, {}});
    schema_.add({"Status", Type::kUint8, 1, 1, 0, {}});
  }
  void add(const World3& place, const World3& normal, double mean, double gauss, int status = 0) {
    points_.world.push_back(place);
    points_.rows.resize(points_.rows.size() + schema_.row_size());
    std::byte* row = points_.rows.data() + points_.rows.size() - schema_.row_size();
    const double values[]{normal[0], normal[1], normal[2],
                          mean,      gauss,     static_cast<double>(status)};
    const std::vector<Dimension> dimensions = schema_.dimensions();
    for (std::size_t i = 0; i < 6; ++i) write_value(dimensions[i], row, values[i]);
  }
  Measurement measurement() const {
    MemoryReader reader(schema_, points_);
    return measured(reader, sphere_at({0, 0, 0}));
  }

 private:
  Schema schema_;
  PointBatch points_;
};

TEST(Measure, ComparesCurvatureBySignOfTheNormal) {
  DescribedSphere sphere;
  sphere.add({2, 0, 0}, {1, 0, 0}, -0.5, 0.25);
  sphere.add({-2, 0, 0}, {1, 0, 0}, 0.5, 0.25);

  const Measurement found = sphere.measurement();

  EXPECT_EQ(found.normal->count(), 2u);
  EXPECT_EQ(found.normal->max(), 0);
  EXPECT_EQ(found.mean_curvature->max(), 0);
  EXPECT_EQ(found.gaussian_curvature->max(), 0);
}

TEST(Measure, GivesTheAngleOfANormalAndTheErrorOfCurvature) {
  DescribedSphere sphere;
  sphere.add({0, 2, 0}, {std::sin(0.01), std::cos(0.01), 0}, -0.4, 0.5);

  const Measurement found = sphere.measurement();

  EXPECT_NEAR(found.normal->rms(), 0.01, 1e-7);
  EXPECT_NEAR(found.mean_curvature->rms(), 0.1, 1e-7);
  EXPECT_NEAR(found.gaussian_curvature->mean(), 0.25, 1e-7);
}

TEST(Measure, TakesNoWordOnTheSurfaceFromPointsThatStayed) {
  DescribedSphere sphere;
  sphere.add({0, 2, 0}, {0, 0, 0}, 0, 0);
  sphere.add({0, 2, 0}, {1, 0, 0}, 7, 7, static_cast<int>(Status::kOutOfDomain));
  sphere.add({0, 2, 0}, {0, 1, 0}, -0.5, 0.25, kSecondSheetFlag);

  const Measurement found = sphere.measurement();

  EXPECT_EQ(found.distance.count(), 3u);
  EXPECT_EQ(found.normal->count(), 1u);
  EXPECT_EQ(found.mean_curvature->max(), 0);
}

TEST(Magnitudes, PercentilesAgreeWithSortedValues) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-30, 5);
  Magnitudes magnitudes;
  std::vector<double> values;
  for (int i = 0; i < 10'000; ++i) {
    values.push_back(std::pow(10, exponent(random)));
    magnitudes.add(i % 2 == 0 ? values.back() : -values.back());
  }
  std::ranges::sort(values);

  for (const std::size_t rank : {1u, 500u, 5000u, 9500u, 9900u, 9999u})
    EXPECT_NEAR(magnitudes.percentile(static_cast<double>(rank) / 10'000) / values[rank - 1], 1,
                0.008);
  EXPECT_EQ(magnitudes.percentile(1), values.back());
  EXPECT_EQ(magnitudes.max(), values.back());
}

TEST(Magnitudes, HoldZerosAndTheExtremesOfDouble) {
  Magnitudes magnitudes;
  EXPECT_EQ(magnitudes.percentile(0.5), 0);
  EXPECT_EQ(magnitudes.rms(), 0);
  magnitudes.add(0);
  magnitudes.add(-0.0);
  magnitudes.add(std::numeric_limits<double>::denorm_min());
  magnitudes.add(-std::numeric_limits<double>::max());

  EXPECT_EQ(magnitudes.count(), 4u);
  EXPECT_LT(magnitudes.percentile(0.5), 1e-300);
  EXPECT_EQ(magnitudes.max(), std::numeric_limits<double>::max());
}

TEST(MeasurementText, GivesDistancesInUnitsAndInSpacings) {
  PointBatch points;
  points.world = {{3, 0, 0}};
  MemoryReader reader(Schema{}, points);
  SynthOptions truth = sphere_at({0, 0, 0});
  truth.points = 201;  // spacing sqrt(16 pi / 201) = 0.5000769
  const Measurement found = measured(reader, truth);

  const std::string json = measurement_json(found, truth);
  const std::string table = measurement_table(found, truth);

  EXPECT_NE(json.find("\"rms\": 1.0,"), std::string::npos) << json;
  EXPECT_NE(json.find("\"rms\": 1.9996"), std::string::npos) << json;
  EXPECT_NE(table.find("distance to the surface"), std::string::npos) << table;
  EXPECT_NE(table.find("      2  "), std::string::npos) << table;
}

}  // namespace
}  // namespace pss::test
