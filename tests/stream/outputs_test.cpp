#include "stream/outputs.h"

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
  projection.gaussian_curvature = 4;
  projection.residual = 0.25;
  projection.boundary = 0.5;
  std::vector<std::byte> row(schema.row_size(), std::byte{0x5a});

  columns.write(projection, row.data());

  const std::vector<std::pair<const char*, double>> expected = {
      {"Intensity", 0x5a5a},     {"NormalX", 0},        {"NormalY", double{0.6f}},
      {"NormalZ", double{0.8f}}, {"MeanCurvature", -2}, {"GaussianCurvature", 4},
      {"Displacement", 13},      {"Residual", 0.25},    {"Neighbors", 77},
      {"Boundary", 0.5},         {"Status", 1}};
  const std::vector<Dimension> dimensions = schema.dimensions();
  ASSERT_EQ(dimensions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(dimensions[i].name, expected[i].first);
    EXPECT_EQ(read_value(dimensions[i], row.data()), expected[i].second) << expected[i].first;
  }
}

TEST(Outputs, OverwriteAnAttributeOfTheSameNameAndType) {
  Schema schema({{"Residual", Type::kFloat32, 1, 1, 0, {}}, {"Red", Type::kUint16, 1, 1, 0, {}}});

  const auto columns = OutputColumns::add_to(schema, kResidual);

  EXPECT_TRUE(columns.has_value());
  EXPECT_EQ(schema.fields().size(), 2u);
}

TEST(Outputs, RefuseAnAttributeOfTheSameNameAndAnotherType) {
  Schema schema({{"Status", Type::kFloat64, 1, 1, 0, {}}});

  const auto columns = OutputColumns::add_to(schema, kStatus);

  ASSERT_FALSE(columns);
  EXPECT_EQ(columns.error().fault, Fault::kUsage);
  EXPECT_NE(columns.error().message.find("float64"), std::string::npos);
}

}  // namespace
}  // namespace pss
