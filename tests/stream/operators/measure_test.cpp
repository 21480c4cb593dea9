// Measurements of neighbourhoods and selection by them, against the definitions.

#include "stream/operators/measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/parallel.h"
#include "core/support.h"
#include "stream/operators/select.h"
#include "tests/stream/project_fixture.h"

namespace pss::test {
namespace {

constexpr int kK = 6;
constexpr double kCap = 2.5;

/// A tenth of the wave twice, and some points far above and below it.
Cloud wave_with_outliers() {
  const Cloud plain = wave(31);
  std::vector<std::pair<Index3, std::byte>> points;
  for (std::size_t i = 0; i < plain.positions.size(); ++i) {
    points.emplace_back(plain.positions[i], plain.rows[i]);
    if (i % 10 == 0) points.emplace_back(plain.positions[i], plain.rows[i]);
    if (i % 100 == 3) {
      Index3 far = plain.positions[i];
      far[2] += i % 200 == 3 ? 9000 : -9000;
      points.emplace_back(far, std::byte{0});
    }
  }
  std::ranges::sort(points, {},
                    [](const auto& p) { return std::pair(encode_key(p.first), p.second); });
  Cloud cloud;
  for (const auto& [position, row] : points) {
    cloud.positions.push_back(position);
    cloud.rows.push_back(row);
  }
  return cloud;
}

std::vector<Measurement> measurements(const Store& store) {
  const Cloud cloud = expect_value(read_all(store));
  std::vector<Measurement> found(store.points());
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::memcpy(&found[i].value, &cloud.rows[5 * i], sizeof(std::uint32_t));
    found[i].above = cloud.rows[5 * i + 4] != std::byte{0};
  }
  return found;
}

class Measured : public testing::Test {
 protected:
  /// The distances from point i to all others that count, ascending.
  std::vector<double> distances(std::size_t i) const {
    std::vector<double> distances;
    for (std::size_t j = 0; j < cloud_.positions.size(); ++j)
      if (j != i && cloud_.rows[j] == std::byte{0})
        distances.push_back(
            std::sqrt(distance_sq(kLattice, cloud_.positions[i], cloud_.positions[j])));
    std::ranges::sort(distances);
    return distances;
  }

  TemporaryDirectory folder_;
  Cloud cloud_ = wave_with_outliers();
  Store store_ = store_of(cloud_, folder_ / "s.pss", {1000, 3000, 3001, 5000});
  Source source_{store_};
};

TEST_F(Measured, MeanDistanceIsThatOfTheKNearestPoints) {
  const MeanDistance op(source_, kK, kCap, 0.5, "{}");

  const Store result = run(source_, op, folder_ / "m.pss");

  const std::vector<Measurement> found = measurements(result);
  std::uint64_t nothing = 0;
  for (std::size_t i = 0; i < found.size(); i += 3) {
    if (cloud_.rows[i] != std::byte{0}) continue;
    const std::vector<double> near = distances(i);
    if (near[kK - 1] > kCap) {
      ASSERT_EQ(found[i].value, kNothingMeasured) << i;
      ++nothing;
      continue;
    }
    double sum = 0;
    for (int n = 0; n < kK; ++n) sum += near[static_cast<std::size_t>(n)];
    ASSERT_NEAR(found[i].value * op.quantum(), sum / kK, 2 * op.quantum()) << i;
  }
  EXPECT_GT(nothing, 10u);
  EXPECT_LT(result.bytes_on_disk(), 6 * result.points());
}

TEST_F(Measured, SumsAreThoseOfAllThatWasMeasured) {
  const MeanDistance op(source_, kK, kCap, 0.5, "{}");
  const Store result = run(source_, op, folder_ / "m.pss");

  const auto sums = MeasurementSums::from_bytes(
      expect_value(merged_notes(op, result.tiles(), result.path())).bytes);

  MeasurementSums expected;
  const std::vector<Measurement> found = measurements(result);
  for (std::size_t i = 0; i < found.size(); ++i)
    expected.add(found[i], cloud_.rows[i] != std::byte{0});
  EXPECT_EQ(sums.to_bytes(), expected.to_bytes());
  EXPECT_GT(sums.excluded, 100u);
  EXPECT_GT(sums.nothing, 50u);
}

TEST_F(Measured, NumbersOfNeighboursAreThoseWithinTheRadius) {
  const NeighbourCount op(source_, 1.2, "{}");

  const std::vector<Measurement> found = measurements(run(source_, op, folder_ / "m.pss"));

  for (std::size_t i = 0; i < found.size(); i += 3) {
    if (cloud_.rows[i] != std::byte{0}) continue;
    const std::vector<double> near = distances(i);
    const auto expected = std::ranges::lower_bound(near, 1.2) - near.begin();
    ASSERT_EQ(found[i].value, expected) << i;
  }
}

TEST_F(Measured, ValuesDependOnNeitherTilesNorPartsNorThreads) {
  const MeanDistance op(source_, kK, kCap, 0.5, "{}");
  const std::vector<std::byte> expected =
      expect_value(read_all(run(source_, op, folder_ / "m.pss"))).rows;
  const Store other = store_of(cloud_, folder_ / "o.pss", {7, 100, 6000});
  const Source others(other);
  const ThreadLimit three(3);

  const Store found = run(others, op, folder_ / "n.pss", limit_leaving(500 << 10));

  EXPECT_EQ(expect_value(read_all(found)).rows, expected);
  const auto note = [&](const Store& store) {
    return expect_value(merged_notes(op, store.tiles(), store.path()));
  };
  EXPECT_EQ(note(found), note(expect_value(Store::open(folder_ / "m.pss"))));
}

TEST_F(Measured, ResidualTellsScatterFromASurface) {
  const Method method{.op = MlsOperator::kFast, .degree = 1};
  const FitResidual op(source_, method, support_of_h(1.4, method), "{}");

  const std::vector<Measurement> found = measurements(run(source_, op, folder_ / "m.pss"));

  std::size_t surface = 0, points = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (cloud_.rows[i] != std::byte{0}) continue;
    ++points;
    surface += found[i].value * op.quantum() < 0.25 ? 1 : 0;
    const double height = 0.001 * static_cast<double>(cloud_.positions[i][2]);
    if (std::abs(height) < 6) continue;
    EXPECT_EQ(found[i].value, kNothingMeasured) << "far off the wave";
  }
  EXPECT_GT(surface, points * 97 / 100);
}

/// The measured source, and what a selection leaves of it.
class Selected : public Measured {
 protected:
  Selected() {
    expect_ok(joined_.join(counts_));
    selection_.least = 3;
    selection_.quantum = 1;
  }
  Store select() {
    const SelectOperator op = expect_value(SelectOperator::create(joined_, selection_));
    Store result = run(joined_, op, folder_ / "r.pss");
    counted_ = expect_value(SelectionCounts::from_note(
        expect_value(merged_notes(op, result.tiles(), result.path())), result.path()));
    return result;
  }
  bool outlier(std::size_t i) const {
    return cloud_.rows[i] == std::byte{0} && measured_[i].value < 3;
  }

  Store counts_ = run(source_, NeighbourCount(source_, 1.2, "{}"), folder_ / "c.pss");
  std::vector<Measurement> measured_ = measurements(counts_);
  Source joined_{store_};
  Selection selection_;
  SelectionCounts counted_;
};

TEST_F(Selected, OutliersAreDroppedAndAllElseStaysAsItWas) {
  const Cloud found = expect_value(read_all(select()));

  Cloud expected;
  for (std::size_t i = 0; i < cloud_.positions.size(); ++i) {
    if (outlier(i)) continue;
    expected.positions.push_back(cloud_.positions[i]);
    expected.rows.push_back(cloud_.rows[i]);
  }
  expect_equal(found, expected);
  EXPECT_EQ(counted_.kept + counted_.outliers() + counted_.excluded, cloud_.positions.size());
  EXPECT_EQ(counted_.kept + counted_.excluded, found.positions.size());
  EXPECT_GT(counted_.high, 20u);
  EXPECT_GT(counted_.low, 20u);
}

TEST_F(Selected, OutliersGetAClassByTheSideOnWhichTheyLie) {
  selection_.classify = true;
  selection_.high = 18;
  selection_.output = "NeighborCount";

  const Store result = select();

  const Cloud found = expect_value(read_all(result));
  ASSERT_EQ(found.positions, cloud_.positions);
  const Dimension output = *result.header().schema.dimension("NeighborCount");
  for (std::size_t i = 0; i < cloud_.positions.size(); ++i) {
    const std::byte* row = &found.rows[i * result.header().schema.row_size()];
    const bool excluded = cloud_.rows[i] != std::byte{0};
    const auto expected = !outlier(i)
                              ? cloud_.rows[i]
                              : std::byte{measured_[i].above ? std::uint8_t{18} : std::uint8_t{7}};
    ASSERT_EQ(row[0], expected) << i;
    ASSERT_EQ(read_value(output, row), excluded ? -1.0 : measured_[i].value) << i;
  }
}

TEST_F(Selected, AnOutputTakesNoAttributesPlace) {
  selection_.output = "Classification";

  const auto refused = SelectOperator::create(joined_, selection_);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::kUsage);
}

TEST(SelectedSchema, RefusesAClassificationTooNarrowForTheClasses) {
  const Schema narrow({{"Flags", Type::kUint8, 1, 1, 0, {{"Classification", 0, 4}}}});
  Selection selection;
  selection.classify = true;
  EXPECT_TRUE(selected_schema(narrow, selection));
  selection.high = 18;
  EXPECT_FALSE(selected_schema(narrow, selection));
  EXPECT_EQ(expect_value(selected_schema(Schema(), selection)).fields()[0].name, "Classification");
}

}  // namespace
}  // namespace pss::test
