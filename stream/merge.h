#pragma once
// Several runs as one sequence in order: a k-way merge by a tournament of losers.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/morton.h"
#include "core/result.h"
#include "io/schema.h"
#include "stream/keyed_rows.h"
#include "stream/run.h"
#include "stream/sorted_stream.h"

namespace pss {

/// Source: Knuth, The Art of Computer Programming 3, 5.4.1 (replacement by a tree of losers).
/// Cost:   log2(runs) comparisons a point.
class MergeStream : public SortedStream {
 public:
  /// Begins at the first point with a key not below `from`, where that is given.
  static Result<MergeStream> open(const std::string& folder, std::span<const RunInfo> runs,
                                  const Schema& schema, const std::optional<Key>& from);

  Result<void> read(std::size_t max, KeyedRows& out) override;

 private:
  struct Source {
    RunReader reader;
    KeyedRows block;
    std::size_t at = 0;

    bool ended() const { return at == block.size(); }
  };
  MergeStream() = default;
  Result<void> start(const std::optional<Key>& from);
  bool wins(std::size_t a, std::size_t b) const;
  void replay(std::size_t source);
  std::size_t row_size_ = 0;
  std::vector<Source> sources_;
  std::vector<std::size_t> losers_;  ///< of the match at each inner node; [0] is the winner of all
};

/// What a run being merged holds in memory, and what decoding one block holds on top.
std::uint64_t merge_source_memory(const Schema& schema);
std::uint64_t merge_decode_memory(const Schema& schema);

}  // namespace pss
