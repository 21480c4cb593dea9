#pragma once
// What the tests of the LAS writer share: a file written, its bytes, what a reader finds in it.

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "io/formats/las/las_reader.h"
#include "io/formats/las/las_writer.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/io/point_files.h"
#include "tests/support/test_data.h"

namespace pss::test {

inline Field field(const char* name, Type type, double scale = 1, double offset = 0) {
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
    options.rules.overwrite = true;
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

}  // namespace pss::test
