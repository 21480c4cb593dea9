#include "stream/passes/outputs.h"

#include <gtest/gtest.h>

#include "tests/stream/store_fixture.h"

namespace pss {
namespace {

using test::expect_value;

TEST(Outputs, ReadsListsOfWords) {
  EXPECT_EQ(expect_value(parse_outputs("normals,status")), kNormals | kStatus);
  EXPECT_EQ(expect_value(parse_outputs("all")), kAllOutputs);
  EXPECT_EQ(expect_value(parse_outputs("none")), 0u);
  EXPECT_EQ(expect_value(parse_outputs("")), 0u);
}

TEST(Outputs, NamesTheUnknownWordAndTheKnownOnes) {
  const auto set = parse_outputs("normals,colour");

  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().fault, Fault::kUsage);
  EXPECT_NE(set.error().message.find("\"colour\""), std::string::npos);
  EXPECT_NE(set.error().message.find("curvature"), std::string::npos);
}

TEST(Outputs, AppendsAttributesInTheDocumentedOrderAndWritesThem) {
  Schema schema({{"Intensity", Type::kUint16, 1, 1, 0, {}}});
  const OutputColumns columns = expect_value(OutputColumns::add_to(schema, kAllOutputs));
  Projection projection;
  projection.status = Status::kDegreeReduced;
  projection.neighbours = 77;
  projection.displacement = {3, 4, 12};
  projection.normal = {0, 0.6, 0.8};
  projection.mean_curvature = -2;
  projection.gaussian_curvature = 3;  // k1 = -1, k2 = -3
  projection.principal_direction = {1, 0, 0};
  projection.residual = 0.25;
  projection.boundary = 0.5;
  std::vector<std::byte> row(schema.row_size(), std::byte{0x5a});

  columns.write(projection, row.data());

  const std::vector<std::pair<const char*, double>> expected = {
      {"Intensity", 0x5a5a},       {"NormalX", 0},
      {"NormalY", double{0.6f}},   {"NormalZ", double{0.8f}},
      {"MeanCurvature", -2},       {"GaussianCurvature", 3},
      {"PrincipalCurvature1", -1}, {"PrincipalCurvature2", -3},
      {"PrincipalDirection1X", 1}, {"PrincipalDirection1Y", 0},
      {"PrincipalDirection1Z", 0}, {"Displacement", 13},
      {"Residual", 0.25},          {"Neighbors", 77},
      {"Boundary", 0.5},           {"Status", 1}};
  const std::vector<Dimension> dimensions = schema.dimensions();
  ASSERT_EQ(dimensions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(dimensions[i].name, expected[i].first);
    EXPECT_EQ(read_value(dimensions[i], row.data()), expected[i].second) << expected[i].first;
  }
}

TEST(Outputs, GiveBothPrincipalCurvaturesOfARoundPlaceItsMean) {
  Schema schema;
  const OutputColumns columns = expect_value(OutputColumns::add_to(schema, kPrincipal));
  Projection projection;
  projection.mean_curvature = 0.5;
  projection.gaussian_curvature = 0.25 + 1e-9;  // rounding may leave K above H^2
  std::vector<std::byte> row(schema.row_size());

  columns.write(projection, row.data());

  for (const char* name : {"PrincipalCurvature1", "PrincipalCurvature2"})
    EXPECT_EQ(read_value(*schema.dimension(name), row.data()), 0.5) << name;
  EXPECT_EQ(read_value(*schema.dimension("PrincipalDirection1X"), row.data()), 0);
}

TEST(Outputs, MarkASecondSheetInTheStatus) {
  Schema schema;
  const OutputColumns columns = expect_value(OutputColumns::add_to(schema, kStatus));
  Projection projection;
  projection.status = Status::kOutOfDomain;
  projection.second_sheet = true;
  std::vector<std::byte> row(schema.row_size());

  columns.write(projection, row.data());

  EXPECT_EQ(row[0], std::byte{4 + 128});
}

TEST(Outputs, TakeThePlaceOfTheAttributeOfTheirNameWithATypeOfTheirOwn) {
  Schema schema({{"Red", Type::kUint16, 1, 1, 0, {}},
                 {"Status", Type::kFloat64, 3, 0.5, 2, {}},
                 {"Blue", Type::kUint16, 1, 1, 0, {}}});

  const OutputColumns columns = expect_value(OutputColumns::add_to(schema, kStatus | kResidual));

  EXPECT_EQ(schema, Schema({{"Red", Type::kUint16, 1, 1, 0, {}},
                            {"Status", Type::kUint8, 1, 1, 0, {}},
                            {"Blue", Type::kUint16, 1, 1, 0, {}},
                            {"Residual", Type::kFloat32, 1, 1, 0, {}}}));
  ASSERT_EQ(columns.kept().size(), 2u);
  EXPECT_EQ(columns.kept()[1].from, 2u + 24);
  EXPECT_EQ(columns.kept()[1].to, 2u + 1);
  EXPECT_EQ(columns.kept()[1].size, 2u);
}

TEST(Outputs, KeepARowThatNothingClashesWithInOnePiece) {
  Schema schema({{"Red", Type::kUint16, 1, 1, 0, {}}, {"Blue", Type::kUint16, 1, 1, 0, {}}});

  const OutputColumns columns = expect_value(OutputColumns::add_to(schema, kAllOutputs));

  ASSERT_EQ(columns.kept().size(), 1u);
  EXPECT_EQ(columns.kept()[0].size, 4u);
}

TEST(Outputs, TakeThePlaceOfTheFirstOfSeveralAndTheOthersGo) {
  Schema schema({{"ny", Type::kFloat64, 1, 1, 0, {}},
                 {"NORMALX", Type::kFloat32, 1, 1, 0, {}},
                 {"nx", Type::kFloat32, 1, 1, 0, {}}});

  expect_value(OutputColumns::add_to(schema, kNormals));

  EXPECT_EQ(schema, Schema({{"NormalY", Type::kFloat32, 1, 1, 0, {}},
                            {"NormalX", Type::kFloat32, 1, 1, 0, {}},
                            {"NormalZ", Type::kFloat32, 1, 1, 0, {}}}));
}

TEST(Outputs, ClashInAnyCaseAndByTheNamesThatPlyGivesNormals) {
  const Schema schema({{"ny", Type::kFloat64, 1, 1, 0, {}},
                       {"displacement", Type::kFloat32, 1, 1, 0, {}},
                       {"status_", Type::kUint8, 1, 1, 0, {}},
                       {"Residual", Type::kFloat32, 1, 1, 0, {}}});

  const auto clashes = clashes_of(schema, kAllOutputs & ~unsigned{kResidual});

  ASSERT_EQ(clashes.size(), 2u);
  EXPECT_EQ(clashes[0].attribute, "ny");
  EXPECT_EQ(clashes[0].output, "NormalY");
  EXPECT_EQ(clashes[0].word, "normals");
  EXPECT_EQ(clashes[1].attribute, "displacement");
  EXPECT_EQ(clashes[1].output, "Displacement");
}

TEST(Outputs, CannotTakeThePlaceOfBitsAmongOthers) {
  Schema schema({{"Flags", Type::kUint8, 1, 1, 0, {{"Status", 0, 3}, {"Other", 3, 5}}}});

  const auto columns = OutputColumns::add_to(schema, kStatus);

  ASSERT_FALSE(columns);
  EXPECT_EQ(columns.error().fault, Fault::kUsage);
  EXPECT_NE(columns.error().message.find("3 bits of Flags"), std::string::npos);
}

}  // namespace
}  // namespace pss
