#pragma once
// Small files of points for the tests of readers and writers.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "io/points/points.h"
#include "io/points/reader.h"
#include "io/points/schema.h"
#include "io/points/writer.h"

namespace pss::test {

inline void write_text_file(const std::string& path, std::string_view content) {
  std::ofstream(path, std::ios::binary)
      .write(content.data(), static_cast<std::streamsize>(content.size()));
}

inline std::string read_text_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// All points that are left, read in batches of `step`.
inline Result<PointBatch> read_all(Reader& reader, std::size_t step = 1000) {
  PointBatch all;
  for (PointBatch batch;;) {
    PSS_TRY(reader.read(step, batch));
    if (batch.size() == 0) return all;
    all.index.insert(all.index.end(), batch.index.begin(), batch.index.end());
    all.world.insert(all.world.end(), batch.world.begin(), batch.world.end());
    all.rows.insert(all.rows.end(), batch.rows.begin(), batch.rows.end());
  }
}

/// Opens a file and reads it whole.
template <class Open>
Result<PointBatch> open_and_read(Open open, const std::string& path) {
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, open(path));
  return read_all(*reader, 7);
}

/// What every damaged file must give: its points, or a clear refusal.
inline void expect_bad_input_or_points(const Result<PointBatch>& points) {
  if (points) return;
  EXPECT_EQ(points.error().fault, Fault::kBadInput) << points.error().message;
}

/// The value of a dimension of the i-th point.
inline double value_at(const Schema& schema, const PointBatch& points, std::size_t i,
                       std::string_view name) {
  const auto dimension = schema.dimension(name);
  EXPECT_TRUE(dimension.has_value()) << name;
  return dimension ? read_value(*dimension, points.rows.data() + i * schema.row_size()) : -1e99;
}

/// What a copy of a file's points needs: same schema, same count, header carried on.
inline WriteOptions copy_options(const CloudHeader& header, std::uint64_t count) {
  WriteOptions options;
  options.schema = header.schema;
  options.count = count;
  options.carry = header.carry;
  return options;
}

/// Equal bytes, so that NaN equals itself and -0 is not 0.
inline bool same_positions(const PointBatch& a, const PointBatch& b) {
  return a.world.size() == b.world.size() &&
         std::memcmp(a.world.data(), b.world.data(), a.world.size() * sizeof(World3)) == 0;
}

}  // namespace pss::test
