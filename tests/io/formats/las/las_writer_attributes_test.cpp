// Attributes in the LAS writer: extra bytes, point formats, names, values that do not fit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/io/formats/las/las_writer_fixture.h"

namespace pss::test {
namespace {

TEST_F(LasWriterTest, AppendsAttributesAsExtraBytes) {
  read(las({.format = 1, .points = 3, .vlrs = vlr("someone", 9, "keep me"), .vlr_count = 1}));
  WriteOptions options = carried();
  const PointBatch before = points_;
  const Type types[] = {Type::kUint8, Type::kInt8,   Type::kUint16, Type::kInt16,   Type::kUint32,
                        Type::kInt32, Type::kUint64, Type::kInt64,  Type::kFloat32, Type::kFloat64};
  for (const Type type : types) append_value(options.schema, field(type_name(type), type), 10);
  append_value(options.schema, field("scaled", Type::kInt16, 0.5, 100), 101);

  const std::string out = write(options, points_);

  const std::size_t vlr_at = 227 + 54 + 7;
  EXPECT_EQ(get<std::uint32_t>(out, 100), 2u);
  EXPECT_EQ(get<std::uint32_t>(out, 96), vlr_at + 54 + 11 * 192);
  EXPECT_EQ(get<std::uint16_t>(out, 105), 28 + 2 * (1 + 2 + 4 + 8) + 12 + 2);
  EXPECT_EQ(out.substr(227, 61), vlr("someone", 9, "keep me"));
  EXPECT_STREQ(out.c_str() + vlr_at + 2, "LASF_Spec");
  EXPECT_EQ(get<std::uint16_t>(out, vlr_at + 18), 4);
  for (std::size_t t = 0; t < 10; ++t)  // the specification numbers the types 1 to 10 in this order
    EXPECT_EQ(out[vlr_at + 54 + 192 * t + 2], static_cast<char>(t + 1));
  read(out);
  EXPECT_EQ(header_.schema, options.schema);
  EXPECT_EQ(points_.index, before.index);
  for (const Type type : types)
    EXPECT_EQ(value_at(header_.schema, points_, 2, type_name(type)), 12);
  EXPECT_EQ(value_at(header_.schema, points_, 2, "scaled"), 103);
}

TEST_F(LasWriterTest, ExtendsTheExtraBytesThatAreThere) {
  const std::string old = descriptor(3, "Amplitude", 8, 0.25);
  const std::string vlrs = vlr("LASF_Spec", 4, old) + vlr("someone", 9, "x");
  read(las({.format = 1, .extra = 5, .points = 2, .vlrs = vlrs, .vlr_count = 2}));
  WriteOptions options = carried();
  append_value(options.schema, field("Status", Type::kUint8), 1);

  const std::string out = write(options, points_);

  EXPECT_EQ(get<std::uint32_t>(out, 100), 2u);
  EXPECT_NE(out.find(old), std::string::npos);
  read(out);
  EXPECT_EQ(header_.schema, options.schema);
  EXPECT_EQ(header_.schema.dimension("ExtraBytes")->count, 3u);
  EXPECT_EQ(value_at(header_.schema, points_, 1, "Status"), 2);
}

TEST_F(LasWriterTest, RaisesThePointFormatOnlyWhereAnAttributeNeedsIt) {
  struct Case {
    int format;
    Field added;
    int expected_format, expected_minor;
  };
  for (const Case& c :
       {Case{0, field("GpsTime", Type::kFloat64), 1, 2}, Case{0, field("Red", Type::kUint16), 2, 2},
        Case{1, field("Green", Type::kUint16), 3, 2},
        Case{2, field("GpsTime", Type::kFloat64), 3, 2},
        Case{1, field("Infrared", Type::kUint16), 8, 4},
        Case{0, field("Overlap", Type::kUint8), 6, 4},
        Case{3, field("ScannerChannel", Type::kUint8), 7, 4},
        Case{1, field("WaveX", Type::kFloat32), 4, 3},
        Case{1, field("Other", Type::kFloat32), 1, 2}}) {
    read(las({.format = c.format, .points = 2}));
    const CloudHeader before = header_;
    const PointBatch points = points_;
    WriteOptions options = carried();
    append_value(options.schema, c.added, 1);
    const std::string out = write(options, points_);
    EXPECT_EQ(out[104], c.expected_format) << c.added.name;
    EXPECT_EQ(out[25], c.expected_minor) << c.added.name;
    read(out);
    EXPECT_EQ(value_at(header_.schema, points_, 0, c.added.name), 1);
    for (const Dimension& d : before.schema.dimensions()) {
      if (d.name == "ScanAngleRank") continue;
      EXPECT_EQ(value_at(header_.schema, points_, 1, d.name),
                value_at(before.schema, points, 1, d.name))
          << d.name;
    }
    EXPECT_NEAR(value_at(header_.schema, points_, 1, "ScanAngleRank"),
                value_at(before.schema, points, 1, "ScanAngleRank"), 0.003);
  }
}

TEST_F(LasWriterTest, KnowsTheNamesThatOtherFormatsUseWhereNothingIsLost) {
  WriteOptions options;
  options.schema = Schema({field("red", Type::kUint8), field("gps_time", Type::kFloat64),
                           field("intensity", Type::kFloat32)});
  options.count = 1;
  PointBatch points;
  points.world = {{0, 0, 0}};
  points.rows.resize(13);
  write_value(*options.schema.dimension("red"), points.rows.data(), 200);
  write_value(*options.schema.dimension("intensity"), points.rows.data(), 0.5);

  read(write(options, points));

  EXPECT_EQ(value_at(header_.schema, points_, 0, "Red"), 200);
  EXPECT_EQ(value_at(header_.schema, points_, 0, "intensity"), 0.5);  // too fine for Intensity
  EXPECT_TRUE(header_.schema.dimension("GpsTime"));
}

TEST_F(LasWriterTest, CountsValuesThatTheFormatCannotHold) {
  WriteOptions options;
  options.schema = Schema({field("Intensity", Type::kFloat64)});
  options.count = 3;
  PointBatch points;
  points.world.resize(3);
  points.rows.resize(24);
  const Dimension intensity = *options.schema.dimension("Intensity");
  write_value(intensity, points.rows.data(), 7);
  write_value(intensity, points.rows.data() + 8, 7.5);
  write_value(intensity, points.rows.data() + 16, 70000);

  read(write(options, points));

  EXPECT_EQ(value_at(header_.schema, points_, 0, "Intensity"), 7);
  EXPECT_EQ(value_at(header_.schema, points_, 2, "Intensity"), 65535);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("Intensity: 2 values"), std::string::npos) << notes_[0];
}

TEST_F(LasWriterTest, RefusesMoreAttributesThanLasCanDescribe) {
  WriteOptions options;
  for (int i = 0; i < 342; ++i)
    options.schema.add(field(fmt::format("a{}", i).c_str(), Type::kUint8));

  const auto writer = create_las(path_, options);

  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().message.find("341"), std::string::npos);
}

}  // namespace
}  // namespace pss::test
