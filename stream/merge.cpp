#include "stream/merge.h"

#include <algorithm>
#include <utility>

namespace pss {

Result<MergeStream> MergeStream::open(const std::string& folder, std::span<const RunInfo> runs,
                                      const Schema& schema, const std::optional<Key>& from) {
  MergeStream merge;
  merge.row_size_ = schema.row_size();
  merge.sources_.reserve(runs.size());
  for (const RunInfo& run : runs) {
    PSS_ASSIGN(RunReader reader, RunReader::open(folder, run, schema));
    merge.sources_.push_back({std::move(reader), {}, 0});
  }
  PSS_TRY(merge.start(from));
  return merge;
}

Result<void> MergeStream::start(const std::optional<Key>& from) {
  for (Source& source : sources_) {
    if (from) PSS_TRY(source.reader.seek(*from));
    do {
      PSS_TRY(source.reader.next(source.block));
      const auto& keys = source.block.keys;
      source.at =
          from ? static_cast<std::size_t>(std::ranges::lower_bound(keys, *from) - keys.begin()) : 0;
    } while (source.ended() && source.block.size() > 0);
  }
  // Every source plays from its leaf up; a node without a first player keeps the one that comes.
  const std::size_t none = sources_.size();
  losers_.assign(std::max<std::size_t>(sources_.size(), 1), none);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    std::size_t winner = s;
    std::size_t node = (s + sources_.size()) / 2;
    for (; node > 0 && losers_[node] != none; node /= 2)
      if (wins(losers_[node], winner)) std::swap(losers_[node], winner);
    losers_[node] = winner;
  }
  return {};
}

bool MergeStream::wins(std::size_t a, std::size_t b) const {
  const Source& x = sources_[a];
  const Source& y = sources_[b];
  if (x.ended() || y.ended()) return !x.ended();
  return before(x.block.keys[x.at], x.block.row(x.at), y.block.keys[y.at], y.block.row(y.at),
                row_size_);
}

void MergeStream::replay(std::size_t source) {
  std::size_t winner = source;
  for (std::size_t node = (source + sources_.size()) / 2; node > 0; node /= 2)
    if (wins(losers_[node], winner)) std::swap(losers_[node], winner);
  losers_[0] = winner;
}

Result<void> MergeStream::read(std::size_t max, KeyedRows& out) {
  out.clear();
  out.row_size = row_size_;
  while (out.size() < max && !sources_.empty()) {
    Source& source = sources_[losers_[0]];
    if (source.ended()) break;
    out.keys.push_back(source.block.keys[source.at]);
    const std::byte* row = source.block.row(source.at);
    out.rows.insert(out.rows.end(), row, row + row_size_);
    if (++source.at == source.block.size()) {
      PSS_TRY(source.reader.next(source.block));
      source.at = 0;
    }
    replay(losers_[0]);
  }
  return {};
}

std::uint64_t merge_source_memory(const Schema& schema) {
  constexpr std::uint64_t kFileAndVectors = 1024;
  return kRunBlockPoints * (sizeof(Key) + schema.row_size()) + kFileAndVectors;
}

std::uint64_t merge_decode_memory(const Schema& schema) {
  // The compressed block, its positions, and the planes of its widest column.
  return 3 * kRunBlockPoints * (2 * sizeof(Index3) + schema.row_size());
}

}  // namespace pss
