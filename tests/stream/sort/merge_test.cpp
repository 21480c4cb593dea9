#include "stream/sort/merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

/// A point as one value that compares in the one order: key, then the byte of the row.
struct Point {
  Key key;
  std::uint8_t row = 0;

  auto operator<=>(const Point&) const = default;
};
using Points = std::vector<Point>;

Schema one_byte() { return Schema({{"Classification", Type::kUint8, 1, 1, 0, {}}}); }

RunInfo write_run(const std::string& folder, std::uint64_t id, const Points& points) {
  RunWriter run = expect_value(RunWriter::create(folder, id));
  for (std::size_t begin = 0; begin < points.size(); begin += kRunBlockPoints) {
    const std::size_t end = std::min(points.size(), begin + kRunBlockPoints);
    std::vector<Index3> positions;
    std::vector<std::byte> rows;
    for (std::size_t i = begin; i < end; ++i) {
      positions.push_back(decode_key(points[i].key));
      rows.push_back(std::byte{points[i].row});
    }
    expect_ok(run.append(points[begin].key, encode_block(one_byte(), positions, rows)));
  }
  return expect_value(run.finish());
}

Points read_whole(MergeStream& stream, std::size_t at_once) {
  Points all;
  std::vector<Key> keys(at_once);
  std::vector<std::byte> rows(at_once);
  while (const std::size_t count = expect_value(stream.read(keys, rows)))
    for (std::size_t i = 0; i < count; ++i)
      all.push_back({keys[i], static_cast<std::uint8_t>(rows[i])});
  return all;
}

/// Runs that are hard on a merge, of about 9,000 points each.
std::vector<Points> make_runs(const std::string& kind, std::size_t count) {
  std::mt19937_64 random(7);
  std::vector<Points> runs(count);
  for (std::size_t r = 0; r < count; ++r) {
    const std::size_t size = kind == "of any length" ? random() % 20000 + 1 : 9000 + r;
    for (std::size_t i = 0; i < size; ++i) {
      std::int64_t x = static_cast<std::int64_t>(random() % 1000000);
      if (kind == "one after the other") x = static_cast<std::int64_t>(r * size + i);
      if (kind == "the last one first") x = static_cast<std::int64_t>((count - r) * size + i);
      if (kind == "all points at one place") x = 5;
      if (kind == "few places") x %= 3;
      runs[r].push_back({encode_key({x, -x, x / 2}), static_cast<std::uint8_t>(random() % 4)});
    }
    std::ranges::sort(runs[r]);
  }
  return runs;
}

class Merge : public testing::TestWithParam<const char*> {};

TEST_P(Merge, GivesWhatSortingAllRunsTogetherGives) {
  const Monitor monitor;
  const Schema schema = one_byte();
  for (const std::size_t count : {1u, 2u, 7u}) {
    test::TemporaryDirectory folder;
    const std::vector<Points> runs = make_runs(GetParam(), count);
    std::vector<RunInfo> infos;
    Points expected;
    for (const Points& run : runs) {
      infos.push_back(write_run(folder / ".", infos.size(), run));
      expected.insert(expected.end(), run.begin(), run.end());
    }
    std::ranges::sort(expected);
    for (const std::size_t run_points : {kRunBlockPoints, 4 * kRunBlockPoints}) {
      MergeStream stream = expect_value(
          MergeStream::open(folder / ".", infos, schema, std::nullopt, run_points, monitor));
      EXPECT_TRUE(read_whole(stream, 1000) == expected) << count << ' ' << run_points;
    }
    const Key from = expected[expected.size() / 3].key;
    MergeStream rest = expect_value(
        MergeStream::open(folder / ".", infos, schema, from, kRunBlockPoints, monitor));
    const auto first = std::ranges::lower_bound(expected, from, {}, &Point::key);
    EXPECT_TRUE(read_whole(rest, 5000) == Points(first, expected.end())) << count;
  }
}

INSTANTIATE_TEST_SUITE_P(Runs, Merge,
                         testing::Values("random", "of any length", "one after the other",
                                         "the last one first", "all points at one place",
                                         "few places"),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace pss
