#pragma once
// Small clouds and stores for the tests of this folder.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "core/morton.h"
#include "stream/store/store.h"

namespace pss::test {

/// Fails the test with the error's text where there is one, and gives the value.
template <class T>
T expect_value(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << result.error().message;
    std::abort();
  }
  return *std::move(result);
}

inline void expect_ok(const Result<void>& result) {
  EXPECT_TRUE(result.has_value()) << result.error().message;
}

inline std::vector<std::byte> bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> chars{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::byte> bytes(chars.size());
  std::memcpy(bytes.data(), chars.data(), chars.size());
  return bytes;
}

inline void write_bytes(const std::string& path, std::span<const std::byte> bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

/// Flips one bit of a file in its place.
inline void flip_bit(const std::string& path, std::size_t bit) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekg(static_cast<std::streamoff>(bit / 8));
  const int byte = file.get();
  file.seekp(static_cast<std::streamoff>(bit / 8));
  file.put(static_cast<char>(byte ^ 1 << bit % 8));
}

/// Every kind of field: integers of each width, floats, an array, a bit container.
inline Schema rich_schema() {
  return Schema({{"Intensity", Type::kUint16, 1, 1, 0, {}},
                 {"Flags", Type::kUint8, 1, 1, 0, {{"ReturnNumber", 0, 3}, {"Withheld", 7, 1}}},
                 {"GpsTime", Type::kFloat64, 1, 1, 0, {}},
                 {"Extra", Type::kInt32, 3, 0.5, 2, {}},
                 {"Id", Type::kUint64, 1, 1, 0, {}}});
}

struct Cloud {
  std::vector<Index3> positions;
  std::vector<std::byte> rows;
};

/// `count` points in [-extent, extent)^3 in key order, rows of random bytes.
inline Cloud random_cloud(std::size_t count, std::int64_t extent, std::size_t row_size,
                          std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> along(-extent, extent - 1);
  Cloud cloud;
  for (std::size_t i = 0; i < count; ++i)
    cloud.positions.push_back({along(random), along(random), along(random)});
  std::ranges::sort(cloud.positions,
                    [](const Index3& a, const Index3& b) { return encode_key(a) < encode_key(b); });
  cloud.rows.resize(count * row_size);
  for (std::byte& b : cloud.rows) b = static_cast<std::byte>(random() & 0xff);
  return cloud;
}

/// Appends the rows [begin, end) of a cloud as one tile of the whole lattice; none: an empty one.
inline Result<void> append_tile(StoreWriter& writer, const Schema& schema, const Cloud& cloud,
                                std::size_t begin, std::size_t end, bool sync = true) {
  const std::size_t row = schema.row_size();
  for (std::size_t i = begin; i < end; i += kBlockPoints) {
    const std::size_t n = std::min<std::size_t>(kBlockPoints, end - i);
    PSS_TRY(writer.append(encode_block(schema, std::span(cloud.positions).subspan(i, n),
                                       std::span(cloud.rows).subspan(i * row, n * row))));
  }
  return writer.commit_tile(Cell{}, writer.next_source(), {3, {std::byte{7}, std::byte{9}}}, sync);
}

/// Input `number` as a table of inputs has it, whatever the file.
inline InputFacts facts_of(const InputRecord& record, std::uint64_t number = 0) {
  return {record, "PLY", Lattice{{0.5, 1, 2}, {3, 4, 5}}, {10 + number, 1, 2, 3}};
}

/// A table of these inputs, each with a head of its own.
inline Result<void> write_inputs(const std::string& store, std::span<const InputRecord> inputs,
                                 const Carry& carry) {
  PSS_ASSIGN(InputTableWriter table, InputTableWriter::create(store, inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i)
    PSS_TRY(table.add(facts_of(inputs[i], i), i == 0 ? "EPSG:32633" : "", carry));
  return table.finish();
}

/// Everything a store holds, read by blocks.
inline Result<Cloud> read_all(const Store& store) {
  Cloud cloud;
  const std::size_t row = store.header().schema.row_size();
  for (std::size_t t = 0; t < store.tiles().size(); ++t) {
    PSS_ASSIGN(const auto blocks, store.read_index(t));
    for (const BlockInfo& block : blocks) {
      const std::size_t first = cloud.positions.size();
      cloud.positions.resize(first + block.count);
      cloud.rows.resize((first + block.count) * row);
      PSS_TRY(
          store.read_positions(store.tiles()[t], block, std::span(cloud.positions).subspan(first)));
      PSS_TRY(store.read_rows(store.tiles()[t], block, std::span(cloud.rows).subspan(first * row)));
    }
  }
  return cloud;
}

}  // namespace pss::test
