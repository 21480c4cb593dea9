// How fast are blocks compressed and read, a core, and how small do they get?

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "core/morton.h"
#include "stream/store/store.h"

namespace pss {
namespace {

struct Rows {
  Schema schema;
  std::vector<Index3> positions;
  std::vector<std::byte> rows;
};

/// A full block of LAS-like rows on a plane, in key order.
Rows las_like_block() {
  Rows block{Schema({{"Intensity", Type::kUint16, 1, 1, 0, {}},
                     {"Classification", Type::kUint8, 1, 1, 0, {}},
                     {"GpsTime", Type::kFloat64, 1, 1, 0, {}}}),
             {},
             {}};
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < kBlockPoints; ++i) {
    state = state * 6364136223846793005 + 1442695040888963407;
    const auto x = static_cast<std::int64_t>(state >> 50),
               y = static_cast<std::int64_t>(state >> 36 & 0x3fff);
    block.positions.push_back({x, y, static_cast<std::int64_t>(state >> 30 & 63)});
  }
  std::sort(block.positions.begin(), block.positions.end(),
            [](const Index3& a, const Index3& b) { return encode_key(a) < encode_key(b); });
  block.rows.resize(kBlockPoints * block.schema.row_size());
  for (std::size_t i = 0; i < block.rows.size(); ++i)
    block.rows[i] = static_cast<std::byte>(i % block.schema.row_size() < 3 ? i * 31 >> 5 : i >> 12);
  return block;
}

void encode_blocks(benchmark::State& state) {
  const Rows block = las_like_block();
  std::uint64_t bytes = 0;
  for (auto _ : state) bytes = encode_block(block.schema, block.positions, block.rows).bytes.size();
  state.counters["points/s"] = benchmark::Counter(
      static_cast<double>(kBlockPoints * static_cast<std::uint64_t>(state.iterations())),
      benchmark::Counter::kIsRate);
  state.counters["bytes/point"] = static_cast<double>(bytes) / kBlockPoints;
}
BENCHMARK(encode_blocks);

void encode_and_decode_keys(benchmark::State& state) {
  const Rows block = las_like_block();
  for (auto _ : state)
    for (const Index3& position : block.positions)
      benchmark::DoNotOptimize(decode_key(encode_key(position)));
  state.counters["points/s"] = benchmark::Counter(
      static_cast<double>(kBlockPoints * static_cast<std::uint64_t>(state.iterations())),
      benchmark::Counter::kIsRate);
}
BENCHMARK(encode_and_decode_keys);

}  // namespace
}  // namespace pss
