// Points of classes 7 and 18 and withheld points are to nobody's eyes there, whatever the format.
#include "stream/passes/exclusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "io/formats/las/las_schema.h"
#include "stream/passes/normals.h"
#include "stream/widths/widths_json.h"
#include "tests/stream/project_fixture.h"
#include "tests/stream/synth_store.h"

namespace pss::test {
namespace {

/// One way to say that a point is excluded.
struct Kind {
  std::string name;
  Schema schema;
  std::string dimension;
  double value = 0;
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

std::vector<Kind> kinds() {
  std::vector<Kind> kinds;
  for (const std::uint8_t format : {std::uint8_t{1}, std::uint8_t{6}})
    for (const auto& [dimension, value] :
         {std::pair{"Classification", 7}, {"Classification", 18}, {"Withheld", 1}})
      kinds.push_back({"Las" + std::to_string(format) + dimension + std::to_string(value),
                       las_standard_schema(format), dimension, static_cast<double>(value)});
  for (const auto& [type, word] : {std::pair{Type::kInt32, "Int32"}, {Type::kFloat64, "Float64"}}) {
    const Schema classes({{"Red", type, 1, 1, 0, {}}, {"Classification", type, 1, 1, 0, {}}});
    const Schema withheld({{"Withheld", type, 1, 1, 0, {}}, {"Red", type, 1, 1, 0, {}}});
    kinds.push_back({std::string(word) + "Classification7", classes, "Classification", 7});
    kinds.push_back({std::string(word) + "Classification18", classes, "Classification", 18});
    kinds.push_back({std::string(word) + "Withheld", withheld, "Withheld", 1});
  }
  return kinds;
}

/// Points on kLattice, each with whether it is excluded, in key order.
struct MarkedPoint {
  Index3 position{};
  bool excluded = false;
};

/// A noisy square of 60 x 60 points, a unit apart, and as many excluded ones: half among them,
/// half a little above, where they would pass for noise and for another sheet.
std::vector<MarkedPoint> marked_points() {
  Random random(21);
  std::vector<MarkedPoint> points;
  const auto add = [&](double x, double y, double z, bool excluded) {
    points.push_back({to_index(kLattice, {500000 + x + random.uniform(-0.2, 0.2),
                                          4649776 + y + random.uniform(-0.2, 0.2),
                                          100 + z + 0.1 * random.normal()}),
                      excluded});
  };
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y) {
      add(x, y, 0, false);
      add(x + 0.5, y + 0.5, (x + y) % 2 == 0 ? 0 : 2.5, true);
    }
  std::ranges::sort(points, {}, [](const MarkedPoint& p) { return encode_key(p.position); });
  return points;
}

/// Rows of class 2, with the flags beside it set in some; the excluded as `kind` says.
Cloud cloud_of(const Kind& kind, const std::vector<MarkedPoint>& points) {
  const std::size_t row = kind.schema.row_size();
  Cloud cloud{{}, std::vector<std::byte>(points.size() * row)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto write = [&](const char* name, double value) {
      if (const auto dimension = kind.schema.dimension(name))
        write_value(*dimension, &cloud.rows[i * row], value);
    };
    cloud.positions.push_back(points[i].position);
    write("Classification", 2);
    write("Synthetic", static_cast<double>(points[i].position[0] & 1));
    write("KeyPoint", static_cast<double>(points[i].position[1] & 1));
    write("ScannerChannel", static_cast<double>(points[i].position[2] & 3));
    if (points[i].excluded) write(kind.dimension.c_str(), kind.value);
  }
  return cloud;
}

std::vector<MarkedPoint> kept_of(std::vector<MarkedPoint> points) {
  std::erase_if(points, [](const MarkedPoint& p) { return p.excluded; });
  return points;
}

/// A store whose tiles end at `cuts`.
Store store_of(const Kind& kind, const std::vector<MarkedPoint>& points, const std::string& path,
               std::vector<std::size_t> cuts) {
  StoreHeader header;
  header.lattice = kLattice;
  header.grid = kLattice;
  header.schema = kind.schema;
  const Cloud cloud = cloud_of(kind, points);
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  cuts.push_back(points.size());
  for (std::size_t begin = 0; const std::size_t end : cuts)
    expect_ok(append_tile(writer, kind.schema, cloud, std::exchange(begin, end), end));
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

/// The same points, excluded ones among them and without those.
class Excluded : public testing::TestWithParam<Kind> {
 protected:
  TemporaryDirectory folder_;
  std::vector<MarkedPoint> points_ = marked_points();
  std::vector<MarkedPoint> kept_ = kept_of(points_);
  Store with_ = store_of(GetParam(), points_, folder_ / "with.pss", {1000, 4500});
  Store without_ = store_of(GetParam(), kept_, folder_ / "without.pss", {1700});

  std::string widths(const Store& store, const WidthOptions& options = {}) {
    MemoryBudget budget(512 * kMiB, 1);
    Monitor monitor;
    return widths_json(expect_value(choose_widths(store, options, Method{}, budget, monitor)))
        .dump(1);
  }

  /// The position and the row of point i, as one thing to compare.
  static std::pair<Index3, std::vector<std::byte>> point(const Cloud& cloud, std::size_t i) {
    const std::size_t row = cloud.rows.size() / cloud.positions.size();
    const auto begin = cloud.rows.begin() + static_cast<std::ptrdiff_t>(i * row);
    return {cloud.positions[i], {begin, begin + static_cast<std::ptrdiff_t>(row)}};
  }

  /// Projects both stores: kept points get the same place and the same outputs.
  Cloud expect_no_influence(const ProjectParameters& parameters) {
    const Cloud found = project(with_, parameters, folder_ / "found.pss");
    const Cloud expected = project(without_, parameters, folder_ / "expected.pss");
    for (std::size_t i = 0, k = 0; i < points_.size(); ++i) {
      if (points_[i].excluded) continue;
      EXPECT_EQ(point(found, i), point(expected, k++)) << i;
    }
    return found;
  }
};
INSTANTIATE_TEST_SUITE_P(Kinds, Excluded, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(Excluded, PointsAreNoPartOfTheSampleNorOfTheSpacing) {
  const SpacingSample found = sample_of(with_);
  const SpacingSample expected = sample_of(without_);

  EXPECT_EQ(found.spacing->spacing, expected.spacing->spacing);
  EXPECT_NEAR(found.spacing->spacing, 1, 0.05) << "the grid's";
  ASSERT_EQ(found.points.size(), kept_.size());
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    EXPECT_EQ(found.points[i].position, expected.points[i].position);
    EXPECT_EQ(found.points[i].d16, expected.points[i].d16);
  }
}

TEST_P(Excluded, PointsChangeNeitherTheNoiseNorTheWidths) {
  EXPECT_NEAR(noise_of(with_).sigma, 0.1, 0.01);
  EXPECT_EQ(widths(with_), widths(without_));
  EXPECT_EQ(widths(with_, {.knn = 30}), widths(without_, {.knn = 30}));
}

TEST_P(Excluded, PointsAreNoNeighboursAndStayAndSaySo) {
  for (const ProjectParameters& parameters : {fixed_support(), nearest_support()}) {
    const Cloud found = expect_no_influence(parameters);

    const std::size_t row = found.rows.size() / found.positions.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!points_[i].excluded) continue;
      const Index3& own = points_[i].position;
      EXPECT_EQ(found.positions[i], (Index3{256 * own[0], 256 * own[1], 256 * own[2]}));
      EXPECT_EQ(found.rows[(i + 1) * row - 1], static_cast<std::byte>(Status::kExcluded));
    }
  }
}

TEST_P(Excluded, PointsChangeNoNormals) {
  ProjectParameters first_pass = fixed_support();
  first_pass.method = normals_method({.op = MlsOperator::kApss});
  first_pass.only_normals = true;
  expect_no_influence(first_pass);
}

TEST(Exclusion, LeavesNoSpacingWhereFewerThanSeventeenPositionsRemain) {
  TemporaryDirectory folder;
  std::vector<MarkedPoint> points = marked_points();
  for (std::size_t i = 0; i < points.size(); ++i) points[i].excluded = i % 500 != 0;

  EXPECT_FALSE(sample_of(store_of(kinds()[0], points, folder / "s.pss", {})).spacing);
}

TEST(Exclusion, OfACopyLeavesItsPositionInTheSample) {
  TemporaryDirectory folder;
  std::vector<MarkedPoint> points = kept_of(marked_points());
  const double expected =
      sample_of(store_of(kinds()[0], points, folder / "a.pss", {})).spacing->spacing;
  for (std::size_t i = 0; i < 3600; i += 2) points.push_back({points[i].position, true});
  std::ranges::stable_sort(points, {}, [](const MarkedPoint& p) { return encode_key(p.position); });

  const SpacingSample found = sample_of(store_of(kinds()[0], points, folder / "b.pss", {999}));

  EXPECT_EQ(found.points.size(), 3600u);
  EXPECT_EQ(found.spacing->spacing, expected);
}

}  // namespace
}  // namespace pss::test
