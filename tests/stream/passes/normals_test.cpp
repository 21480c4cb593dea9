#include "stream/passes/normals.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/parallel.h"
#include "tests/stream/project_fixture.h"

namespace pss::test {
namespace {

Schema schema_of(std::vector<std::string> names, Type type, double scale = 1) {
  Schema schema;
  for (std::string& name : names) schema.add({std::move(name), type, 1, scale, 0, {}});
  return schema;
}

TEST(NormalColumns, AreFoundByEitherNameWhereTheyCanHoldComponents) {
  EXPECT_TRUE(NormalColumns::given(schema_of({"NormalX", "NormalY", "NormalZ"}, Type::kFloat64)));
  EXPECT_TRUE(NormalColumns::given(schema_of({"nz", "a", "ny", "nx"}, Type::kFloat32)));
  EXPECT_TRUE(NormalColumns::given(schema_of({"nx", "ny", "nz"}, Type::kInt16, 1e-4)));
  EXPECT_FALSE(NormalColumns::given(schema_of({"nx", "ny", "nz"}, Type::kInt16)));
  EXPECT_FALSE(NormalColumns::given(schema_of({"nx", "ny", "NormalZ"}, Type::kFloat32)));
}

TEST(NormalColumns, OfAFirstPassAreNotThoseOfTheInput) {
  const Schema computed =
      schema_of({"Red", "pss.NormalX", "pss.NormalY", "pss.NormalZ"}, Type::kFloat32);
  const Method apss{.op = MlsOperator::kApss};

  EXPECT_FALSE(NormalColumns::given(computed));
  EXPECT_TRUE(NormalColumns::computed(computed));
  EXPECT_EQ(without_computed_normals(computed), schema_of({"Red"}, Type::kFloat32));
  EXPECT_EQ(normals_from(computed, apss), NormalsFrom::kFirstPass);
  EXPECT_EQ(normals_from(schema_of({"nx", "ny", "nz"}, Type::kFloat32), apss), NormalsFrom::kInput);
  EXPECT_EQ(normals_from(computed, {}), NormalsFrom::kNowhere);
}

Schema normal_schema() { return schema_of({"Id", "nx", "ny", "nz"}, Type::kFloat32); }

std::array<float, 4> row_of(float id, float x, float y, float z) { return {id, x, y, z}; }

/// A store of one tile with these positions, normals, and their numbers as attribute.
Store store_with_normals(const std::string& path, const std::vector<Index3>& positions,
                         const std::vector<Normal>& normals, bool ordered) {
  StoreHeader header;
  header.lattice = kLattice;
  header.schema = normal_schema();
  header.ordered = ordered;
  Cloud cloud;
  cloud.positions = positions;
  cloud.rows.resize(positions.size() * header.schema.row_size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto row = row_of(static_cast<float>(i), normals[i][0], normals[i][1], normals[i][2]);
    std::memcpy(&cloud.rows[i * sizeof row], row.data(), sizeof row);
  }
  StoreWriter writer = expect_value(StoreWriter::create(path, header));
  expect_ok(append_tile(writer, header.schema, cloud, 0, positions.size()));
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

Part load_all(const Store& store) {
  const Schema& schema = store.header().schema;
  const Source source(store);
  const PartLoader loader(source, {schema.row_size(), {{0, 0, 4}}, NormalColumns::given(schema)});
  PartPlan plan = expect_value(loader.plan({0, 0, store.tiles()[0].blocks}));
  plan.around = {{plan.box, 10}};
  expect_ok(loader.plan_near(plan, store.points()));
  Part part = expect_value(loader.load_own(plan));
  expect_ok(loader.load_near(plan, part));
  return part;
}

TEST(NormalColumns, GiveUnitLengthOrNothing) {
  TemporaryDirectory folder;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Index3> places{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const Store store = store_with_normals(
      folder / "s.pss", places, {{0, 3, 4}, {0, 0, 0}, {1, kNaN, 0}, {0, 0, -1e-3f}}, true);

  const Part part = load_all(store);

  ASSERT_EQ(part.normals.size(), 4u);
  EXPECT_EQ(part.normals[0], (Normal{0, 0.6f, 0.8f}));
  EXPECT_EQ(part.normals[1], (Normal{0, 0, 0}));
  EXPECT_EQ(part.normals[2], (Normal{0, 0, 0}));
  EXPECT_EQ(part.normals[3], (Normal{0, 0, -1}));
}

TEST(Part, KeepsEachNormalWithItsPointAndEqualPlacesInRowOrder) {
  TemporaryDirectory folder;
  // Rows of a result: not in key order, two places twice.
  const std::vector<Index3> rows{{9, 9, 9}, {0, 0, 0}, {3, 1, 2}, {9, 9, 9}, {0, 0, 0}};
  const std::vector<Normal> normals{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};
  const Store store = store_with_normals(folder / "s.pss", rows, normals, false);

  const Part part = load_all(store);

  EXPECT_EQ(part.candidates,
            (std::vector<Index3>{{0, 0, 0}, {0, 0, 0}, {3, 1, 2}, {9, 9, 9}, {9, 9, 9}}));
  EXPECT_EQ(part.normals,
            (std::vector<Normal>{{0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}}));
  EXPECT_EQ(part.own, rows);
  EXPECT_EQ(part.rows.size(), 5 * normal_schema().row_size());
}

ProjectParameters first_pass() {
  ProjectParameters parameters = fixed_support();
  parameters.outputs = 0;
  parameters.only_normals = true;
  return parameters;
}

TEST(FirstPass, WritesTheNormalsOfTheProjectionAndNothingElse) {
  TemporaryDirectory folder;
  const Cloud cloud = wave(11);
  const Store source = store_of(cloud, folder / "s.pss", {1000, 4000});

  const Cloud found = project(source, first_pass(), folder / "n.pss");

  const Store result = expect_value(Store::open(folder / "n.pss"));
  EXPECT_TRUE(without_computed_normals(result.header().schema).fields().empty());
  const Cloud moved = project(source, fixed_support(), folder / "r.pss");
  const Store with_outputs = expect_value(Store::open(folder / "r.pss"));
  for (const char axis : {'X', 'Y', 'Z'}) {
    const auto computed = *result.header().schema.dimension(std::string("pss.Normal") + axis);
    const auto output = *with_outputs.header().schema.dimension(std::string("Normal") + axis);
    for (std::size_t i = 0; i < kPoints; ++i)
      ASSERT_EQ(read_value(computed, &found.rows[i * result.header().schema.row_size()]),
                read_value(output, &moved.rows[i * with_outputs.header().schema.row_size()]));
  }
}

class NormalsChain : public testing::TestWithParam<MlsOperator> {
 protected:
  /// First pass and projection of the wave cut at `cuts`.
  Cloud chain(const Cloud& cloud, const std::vector<std::size_t>& cuts, OutputSet outputs) {
    const Store store = store_of(cloud, folder_ / "s.pss", cuts);
    project(store, first_pass(), folder_ / "n.pss");
    const Store normals = expect_value(Store::open(folder_ / "n.pss"));
    Source source(store);
    expect_ok(source.join(normals));
    ProjectParameters parameters = fixed_support();
    parameters.method = {.op = GetParam(), .degree = 2};
    parameters.outputs = outputs;
    return project(source, parameters, folder_ / "r.pss");
  }
  Schema result_schema() { return expect_value(Store::open(folder_ / "r.pss")).header().schema; }

  TemporaryDirectory folder_;
};

TEST_P(NormalsChain, GivesTheSameRowsHoweverTilesAreCutAndThreadsAreMany) {
  const Cloud cloud = wave(12);
  const ThreadLimit one(1);
  const Cloud expected = chain(cloud, {}, kAllOutputs);
  const ThreadLimit three(3);

  expect_equal(chain(cloud, {1, 100, 2000, 2001, 5000, 6999}, kAllOutputs), expected);
}

TEST_P(NormalsChain, LeavesNormalsInTheResultOnlyWhereTheyAreAskedFor) {
  const Cloud cloud = wave(13);

  chain(cloud, {3000}, 0);
  EXPECT_EQ(result_schema(), class_schema());
  chain(cloud, {3000}, kNormals);
  const Schema schema = result_schema();

  ASSERT_EQ(schema.fields().size(), 4u);
  EXPECT_EQ(schema.fields()[0], class_schema().fields()[0]);
  EXPECT_EQ(schema.fields()[3].name, "NormalZ");
}

INSTANTIATE_TEST_SUITE_P(Operators, NormalsChain,
                         testing::Values(MlsOperator::kApss, MlsOperator::kRimls),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

}  // namespace
}  // namespace pss::test
