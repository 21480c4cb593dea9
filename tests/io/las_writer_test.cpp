#include "io/las_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "io/las_reader.h"
#include "tests/io/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

Field field(const char* name, Type type, double scale = 1, double offset = 0) {
  return {name, type, 1, scale, offset, {}};
}

class LasWriterTest : public ::testing::Test {
 protected:
  /// Writes points as one batch and gives the file's bytes, or the error's text.
  std::string write(const WriteOptions& options, const PointBatch& points) {
    const Result<void> done = try_write(options, points);
    return done ? read_text_file(path_) : done.error().message;
  }

  Result<void> try_write(const WriteOptions& options, const PointBatch& points) {
    PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_las(path_, options));
    PSS_TRY(writer->write(points));
    PSS_TRY(writer->finish());
    notes_ = writer->notes();
    return {};
  }

  /// What a reader finds in a file's content.
  void read(const std::string& content) {
    write_text_file(input_, content);
    auto reader = open_las(input_);
    ASSERT_TRUE(reader) << reader.error().message;
    header_ = (*reader)->header();
    auto points = read_all(**reader);
    ASSERT_TRUE(points) << points.error().message;
    points_ = *std::move(points);
  }

  WriteOptions carried() const {
    WriteOptions options = copy_options(header_, points_.size());
    options.grid = header_.grid;
    options.overwrite = true;
    return options;
  }

  /// Appends a value to every row; the dimension must be the schema's last.
  void append_value(Schema& schema, const Field& f, double first) {
    PointBatch grown = points_;
    const std::size_t before = schema.row_size();
    schema.add(f);
    grown.rows.assign(points_.size() * schema.row_size(), std::byte{0});
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::byte* row = grown.rows.data() + i * schema.row_size();
      std::memcpy(row, points_.rows.data() + i * before, before);
      write_value(*schema.dimension(f.name), row, first + static_cast<double>(i));
    }
    points_ = grown;
  }

  TemporaryDirectory directory_;
  std::string input_ = directory_ / "in.las";
  std::string path_ = directory_ / "out.las";
  CloudHeader header_;
  PointBatch points_;
  std::vector<std::string> notes_;
};

TEST_F(LasWriterTest, CopiesEveryFormatByteForByte) {
  for (int format = 0; format <= 10; ++format)
    for (int minor = format >= 6 ? 4 : format >= 4 ? 3 : 0; minor <= 4; ++minor) {
      LasFile file{.minor = minor,
                   .format = format,
                   .extra = 3,
                   .points = 5,
                   .vlrs = vlr("someone", 1, "content") + "pad",
                   .vlr_count = 1};
      if (minor == 4) {
        file.evlrs = evlr("someone", 2, "more");
        file.evlr_count = 1;
      }
      const std::string content = las(file);
      read(content);
      WriteOptions options = carried();
      options.same_points = true;

      EXPECT_TRUE(write(options, points_) == content) << minor << " " << format;
      EXPECT_TRUE(notes_.empty());
    }
}

TEST_F(LasWriterTest, KeepsAWrongHeaderOnlyForTheSamePoints) {
  std::string content = las({.format = 1, .points = 4});
  put(content, 179, 1e9);                        // a bound that no point has
  put(content, 111 + 4 * 4, std::uint32_t{77});  // fifth returns that are not there
  read(content);
  WriteOptions options = carried();
  options.same_points = true;
  EXPECT_TRUE(write(options, points_) == content);

  options.same_points = false;
  const std::string honest = write(options, points_);

  EXPECT_EQ(get<double>(honest, 179), 3.0);
  EXPECT_EQ(get<std::uint32_t>(honest, 127), 0u);
  EXPECT_TRUE(honest.substr(227) == content.substr(227));
}

TEST_F(LasWriterTest, SaysThatKeptBoundsDoNotHoldThePoints) {
  std::string content = las({.format = 1, .points = 4});
  put(content, 179, 0.5);
  read(content);
  WriteOptions options = carried();
  options.same_points = true;

  EXPECT_TRUE(write(options, points_) == content);

  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("bounds"), std::string::npos);
}

TEST_F(LasWriterTest, RewritesCountsAndBoundsForOtherPoints) {
  for (const int minor : {2, 4}) {
    std::string content = las({.minor = minor, .format = 1, .points = 4});
    const std::size_t at = get<std::uint16_t>(content, 94);
    for (std::size_t i = 0; i < 4; ++i)  // returns 1, 2, 3, 4
      content[at + i * 28 + 14] = static_cast<char>(i + 1);
    read(content);
    points_.index.resize(2);
    points_.rows.resize(2 * header_.schema.row_size());

    const std::string out = write(carried(), points_);

    EXPECT_EQ(out.size(), content.size() - 2 * 28);
    EXPECT_EQ(get<std::uint32_t>(out, 107), 2u);
    EXPECT_EQ(get<std::uint32_t>(out, 111), 1u);
    EXPECT_EQ(get<std::uint32_t>(out, 115), 1u);
    EXPECT_EQ(get<std::uint32_t>(out, 119), 0u);
    const double bounds[] = {1, 0, 1000, 999, 2000.01, 2000};
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_DOUBLE_EQ(get<double>(out, 179 + 8 * i), bounds[i]) << i;
    if (minor == 4) {
      EXPECT_EQ(get<std::uint64_t>(out, 247), 2u);
      EXPECT_EQ(get<std::uint64_t>(out, 263), 1u);
    }
    EXPECT_EQ(out.substr(26, 68), content.substr(26, 68));  // system, software, dates
  }
}

TEST_F(LasWriterTest, FewerPointsThanAnnouncedAreCountedAndMoreAreRefused) {
  read(las({.points = 3}));
  WriteOptions options = carried();
  options.count = 10;
  EXPECT_EQ(get<std::uint32_t>(write(options, points_), 107), 3u);

  options.count = 2;
  EXPECT_NE(write(options, points_).find("found more points than the 2"), std::string::npos);
}

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

TEST_F(LasWriterTest, CountsAbove32BitsBecomeLas14) {
  read(las({.format = 1, .points = 3, .vlrs = vlr("someone", 9, "keep"), .vlr_count = 1}));
  WriteOptions options = carried();
  options.count = std::uint64_t{1} << 32;

  const std::string out = write(options, points_);

  EXPECT_EQ(out[25], 4);
  EXPECT_EQ(get<std::uint16_t>(out, 94), 375);
  EXPECT_EQ(get<std::uint32_t>(out, 96), 375u + 58u);
  EXPECT_EQ(get<std::uint64_t>(out, 247), 3u);
  EXPECT_EQ(out.substr(375, 58), vlr("someone", 9, "keep"));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("LAS 1.4"), std::string::npos);
}

TEST_F(LasWriterTest, DropsRecordsThatWouldLieAndSaysSo) {
  const LasFile file{.minor = 4,
                     .format = 6,
                     .points = 1,
                     .vlrs = vlr("copc", 1, std::string(160, 'c')) + vlr("someone", 9, "keep"),
                     .vlr_count = 2};
  read(las(file));

  const std::string out = write(carried(), points_);

  EXPECT_EQ(get<std::uint32_t>(out, 100), 1u);
  EXPECT_EQ(out.substr(375, 58), vlr("someone", 9, "keep"));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("'copc' 1"), std::string::npos);
}

TEST_F(LasWriterTest, DoesNotPointToWaveDataThatIsNotThere) {
  std::string content = las({.minor = 3, .format = 4, .points = 1});
  put(content, 6, std::uint16_t{0x2 | 0x1});
  put(content, 227, std::uint64_t{content.size()});
  read(content);

  const std::string out = write(carried(), points_);

  EXPECT_EQ(get<std::uint64_t>(out, 227), 0u);
  EXPECT_EQ(get<std::uint16_t>(out, 6), 1);
  ASSERT_FALSE(notes_.empty());
}

TEST_F(LasWriterTest, WithoutAHeaderChoosesTheLeastFormatAndNoClock) {
  WriteOptions options;
  options.schema = Schema({field("Red", Type::kUint16), field("Quality", Type::kFloat32)});
  options.count = 1;
  options.bounds = WorldBox{{500000, 0, -10}, {501000, 1, 10}};
  PointBatch points;
  points.world = {{500123.456789, 0.123456789, -9.87654321}};
  points.rows.resize(6);

  const std::string out = write(options, points);

  EXPECT_EQ(out[25], 2);
  EXPECT_EQ(out[104], 2);
  EXPECT_EQ(get<std::uint16_t>(out, 105), 26 + 4);
  EXPECT_EQ(get<std::uint32_t>(out, 90), 0u);
  read(out);
  // 10^9 steps hold half a side: 500 in 10^-6, 0.5 in 10^-9, 10 in 10^-8.
  EXPECT_EQ(header_.grid->scale, (World3{1e-6, 1e-9, 1e-8}));
  const World3 p = to_world(*header_.grid, points_.index[0]);
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(p[a], points.world[0][a], 0.51 * header_.grid->scale[a]);
  EXPECT_EQ(header_.schema.dimension("Quality")->type, Type::kFloat32);
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

TEST_F(LasWriterTest, RoundsOtherPositionsOnceToTheNearest) {
  read(las({.points = 1}));  // scale 0.01, offset 0, 1000, 2000
  WriteOptions options = carried();
  options.grid.reset();
  points_.index.clear();
  points_.world = {{0.0149, 999.984, 2000.016}};

  read(write(options, points_));

  EXPECT_EQ(points_.index[0], (Index3{1, -2, 2}));
}

TEST_F(LasWriterTest, RefusesPositionsThatDoNotFitNamingPointAndLimits) {
  read(las({.points = 2}));
  WriteOptions options = carried();
  for (const std::int64_t index :
       {std::int64_t{2147483648}, std::int64_t{-2147483649}, INT64_MIN}) {
    points_.index[1][2] = index;
    const auto done = try_write(options, points_);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().fault, Fault::kBadInput);
    EXPECT_NE(done.error().message.find("point 1: found z = "), std::string::npos);
    EXPECT_NE(done.error().message.find("21476836.47"), std::string::npos) << done.error().message;
  }
  options.grid.reset();
  points_.index.clear();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {kNan, HUGE_VAL, -HUGE_VAL, 21474836.476, -21474836.49, 1e300}) {
    points_.world = {{0, 0, 0}, {x, 0, 0}};
    EXPECT_NE(write(options, points_).find("point 1: found x = "), std::string::npos) << x;
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
}

TEST_F(LasWriterTest, TakesScaleAndOffsetOfTheOptions) {
  read(las({.points = 2}));
  WriteOptions options = carried();
  options.scale = World3{0.001, 0.001, 0.001};

  read(write(options, points_));

  EXPECT_EQ(header_.grid, (Lattice{{0.001, 0.001, 0.001}, {0, 1000, 2000}}));
  EXPECT_EQ(points_.index[1], (Index3{1000, -1000, 10}));
}

TEST_F(LasWriterTest, MovesTheOffsetWhereAFinerScaleDoesNotReach) {
  read(las({.points = 2}));
  WriteOptions options = carried();
  options.carry.reset();
  options.grid = Lattice{{0.01, 0.01, 0.01}, {0, 0, 0}};
  options.bounds = WorldBox{{5000000, 0, 0}, {5000100, 1, 1}};
  options.scale = World3{0.0001, 0.0001, 0.0001};
  points_.index = {{500000000, 0, 0}, {500010000, 100, 100}};

  read(write(options, points_));

  EXPECT_NEAR(to_world(*header_.grid, points_.index[1])[0], 5000100, 1e-5);
}

TEST_F(LasWriterTest, RefusesAScaleThatIsNone) {
  read(las({.points = 1}));
  for (const double scale : {0.0, -1.0, HUGE_VAL}) {
    WriteOptions options = carried();
    options.scale = World3{0.01, scale, 0.01};
    const auto done = try_write(options, points_);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().fault, Fault::kUsage);
  }
}

TEST_F(LasWriterTest, AnEmptyFileIsValid) {
  WriteOptions options;
  options.schema = Schema({field("GpsTime", Type::kFloat64)});

  read(write(options, {}));

  EXPECT_EQ(header_.count, 0u);
  EXPECT_EQ(points_.size(), 0u);
}

TEST_F(LasWriterTest, RefusesMoreAttributesThanLasCanDescribe) {
  WriteOptions options;
  for (int i = 0; i < 342; ++i)
    options.schema.add(field(fmt::format("a{}", i).c_str(), Type::kUint8));

  const auto writer = create_las(path_, options);

  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().message.find("341"), std::string::npos);
}

TEST_F(LasWriterTest, RefusesADamagedCarriedHeader) {
  read(las({.points = 1}));
  WriteOptions options = carried();
  for (std::size_t length = options.carry->head.size(); length-- > 1;) {
    options.carry->head.resize(length);
    EXPECT_FALSE(create_las(path_, options)) << length;
  }
}

}  // namespace
}  // namespace pss::test
