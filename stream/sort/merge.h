#pragma once
// Several runs as one sequence in order: a k-way merge, a range of keys at a time.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/monitor.h"
#include "core/morton.h"
#include "core/result.h"
#include "io/points/schema.h"
#include "stream/sort/big_array.h"
#include "stream/sort/chunk.h"
#include "stream/sort/run.h"
#include "stream/sort/sorted_stream.h"

namespace pss {

/// Merges by rounds: of every run the next points are decoded, and all points up to the least of
/// the runs' last ones are sorted together by all threads. What such a round costs does not depend
/// on the number of runs, as a tournament would; ranges that lie in one run, or in one after the
/// other, are in order already, which the sort sees.
class MergeStream : public SortedStream {
 public:
  /// Begins at the first point with a key not below `from`, where that is given.
  ///
  /// Shape: `run_points` of every run are merged in a round; see merge_run_points.
  static Result<MergeStream> open(const std::string& folder, std::span<const RunInfo> runs,
                                  const Schema& schema, const std::optional<Key>& from,
                                  std::size_t run_points, const Monitor& monitor);

  Result<std::size_t> read(std::span<Key> keys, std::span<std::byte> rows) override;

 private:
  /// A run, and those of its points that are decoded.
  struct Source {
    Source(RunReader run, std::size_t capacity, std::size_t row_bytes)
        : reader(std::move(run)), row_size(row_bytes), keys(capacity), rows(capacity * row_bytes) {}

    RunReader reader;
    std::size_t row_size;
    BigArray<Key> keys;
    BigArray<std::byte> rows;
    std::size_t at = 0;   ///< points before it are merged
    std::size_t end = 0;  ///< of the points that are there

    std::size_t left() const { return end - at; }
    std::byte* row(std::size_t i) const { return rows.data() + i * row_size; }
    void forget_merged();
  };
  /// A block on its way to the points of its run.
  struct Arrival {
    std::size_t source = 0;
    std::size_t at = 0;
    RunBlock block;
    Result<void> decoded;
  };
  MergeStream(std::size_t runs, std::size_t run_points, std::size_t row_size,
              const Monitor& monitor);
  Result<void> skip_to(const Key& from);
  Result<void> refill();
  Result<bool> next_block(std::size_t& source, Arrival& arrival);
  void decode(Arrival& arrival);
  std::optional<std::size_t> shortest() const;
  std::size_t count_up_to(const Source& source, const Source& bound) const;
  Result<void> merge_round();
  void take_round(std::span<const std::size_t> counts);

  std::size_t run_points_;
  std::size_t row_size_;
  const Monitor* monitor_;
  std::vector<Source> sources_;
  std::vector<Arrival> arrivals_;
  Chunk round_;
  std::size_t next_ = 0;  ///< of the round
};

/// How many points of each of `runs` runs to merge in a round within `bytes` of memory.
std::size_t merge_run_points(const Schema& schema, std::size_t runs, std::uint64_t bytes);

/// What merging holds: for every run, and for the blocks being decoded.
std::uint64_t merge_source_memory(const Schema& schema, std::size_t run_points);
std::uint64_t merge_decode_memory(const Schema& schema);

}  // namespace pss
