#include "stream/sort/merge.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace pss {
namespace {

/// Longer rounds gain nothing: they leave the caches.
constexpr std::size_t kRoundPoints = 1 << 18;

constexpr std::size_t kCopyGrain = 4096;

}  // namespace

MergeStream::MergeStream(std::size_t runs, std::size_t run_points, std::size_t row_size,
                         const Monitor& monitor)
    : run_points_(run_points),
      row_size_(row_size),
      monitor_(&monitor),
      arrivals_(slots_in_order()),
      round_(runs * run_points, row_size) {
  sources_.reserve(runs);
}

Result<MergeStream> MergeStream::open(const std::string& folder, std::span<const RunInfo> runs,
                                      const Schema& schema, const std::optional<Key>& from,
                                      std::size_t run_points, const Monitor& monitor) {
  MergeStream merge(runs.size(), run_points, schema.row_size(), monitor);
  for (const RunInfo& run : runs) {
    PSS_ASSIGN(RunReader reader, RunReader::open(folder, run, schema));
    Source& source = merge.sources_.emplace_back(std::move(reader), run_points + kRunBlockPoints,
                                                 schema.row_size());
    if (from) PSS_TRY(source.reader.seek(*from));
  }
  if (from) PSS_TRY(merge.skip_to(*from));
  return merge;
}

Result<void> MergeStream::skip_to(const Key& from) {
  for (bool behind = true; behind;) {
    PSS_TRY(refill());
    behind = false;
    for (Source& source : sources_) {
      const auto keys = source.keys.first(source.end);
      source.at = static_cast<std::size_t>(std::ranges::lower_bound(keys, from) - keys.begin());
      behind = behind || (source.left() == 0 && !source.reader.ended());
    }
  }
  return {};
}

void MergeStream::Source::forget_merged() {
  std::copy(keys.data() + at, keys.data() + end, keys.data());
  std::copy(row(at), row(end), rows.data());
  end -= at;
  at = 0;
}

/// Decodes blocks until every run has the points of a round, or no more.
Result<void> MergeStream::refill() {
  const auto arrival = [&](std::size_t k) -> Arrival& { return arrivals_[k % arrivals_.size()]; };
  std::size_t source = 0;
  Result<bool> read = true;
  Result<void> decoded;
  parallel_in_order(
      arrivals_.size(),
      [&](std::size_t k) {
        read = next_block(source, arrival(k));
        return read && *read;
      },
      [&](std::size_t k) { decode(arrival(k)); },
      [&](std::size_t k) {
        decoded = arrival(k).decoded;
        return decoded.has_value();
      });
  PSS_TRY(decoded);  // of blocks before the one that could not be read
  return read ? Result<void>() : std::move(read).error();
}

/// Reads the next block that is needed, of the runs from `source` on; false where all have enough.
Result<bool> MergeStream::next_block(std::size_t& s, Arrival& arrival) {
  for (; s < sources_.size(); ++s) {
    Source& source = sources_[s];
    if (source.left() >= run_points_ || source.reader.ended()) continue;
    // The places behind are free of points in work: blocks of a run follow one another.
    if (source.at > 0) source.forget_merged();
    PSS_TRY(source.reader.next(arrival.block));
    arrival.source = s;
    arrival.at = source.end;
    source.end += arrival.block.count;
    return true;
  }
  return false;
}

void MergeStream::decode(Arrival& arrival) {
  const Source& source = sources_[arrival.source];
  const std::size_t count = arrival.block.count;
  arrival.decoded = source.reader.decode(arrival.block, {source.keys.data() + arrival.at, count},
                                         {source.row(arrival.at), count * row_size_});
}

/// Of the runs with points beyond this round, the one whose points of this round end first.
std::optional<std::size_t> MergeStream::shortest() const {
  const auto last = [&](const Source& s) { return s.at + std::min(s.left(), run_points_) - 1; };
  std::optional<std::size_t> best;
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    const Source& source = sources_[s];
    if (source.left() <= run_points_ && source.reader.ended()) continue;
    if (best) {
      const Source& b = sources_[*best];
      if (!before(source.keys[last(source)], source.row(last(source)), b.keys[last(b)],
                  b.row(last(b)), row_size_))
        continue;
    }
    best = s;
  }
  return best;
}

/// How many points of a run do not come after the last one of this round of `bound`.
///
/// No more than a round has room for: beyond are equal ones at most, which can wait.
std::size_t MergeStream::count_up_to(const Source& source, const Source& bound) const {
  const std::size_t last = bound.at + std::min(bound.left(), run_points_) - 1;
  std::size_t low = 0;
  std::size_t high = std::min(source.left(), run_points_);
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const std::size_t i = source.at + middle;
    const bool after =
        before(bound.keys[last], bound.row(last), source.keys[i], source.row(i), row_size_);
    after ? high = middle : low = middle + 1;
  }
  return low;
}

Result<void> MergeStream::merge_round() {
  round_.clear();
  next_ = 0;
  PSS_TRY(refill());
  const auto bound = shortest();
  std::vector<std::size_t> counts;
  for (const Source& source : sources_)
    counts.push_back(bound ? count_up_to(source, sources_[*bound]) : source.left());
  take_round(counts);
  return round_.sort(*monitor_);
}

/// Copies so many of the next points of every run into the round.
void MergeStream::take_round(std::span<const std::size_t> counts) {
  std::vector<std::size_t> places(counts.size());
  std::exclusive_scan(counts.begin(), counts.end(), places.begin(), std::size_t{0});
  parallel_for(counts.size(), 1, [&](std::size_t s, std::size_t) {
    Source& source = sources_[s];
    parallel_for(counts[s], kCopyGrain, [&](std::size_t begin, std::size_t end) {
      const std::size_t n = end - begin;
      const std::size_t at = places[s] + begin;
      std::ranges::copy_n(source.keys.data() + source.at + begin, static_cast<std::ptrdiff_t>(n),
                          round_.key_places(at, n).begin());
      std::ranges::copy_n(source.row(source.at + begin), static_cast<std::ptrdiff_t>(n * row_size_),
                          round_.row_places(at, n).begin());
    });
    source.at += counts[s];
  });
  round_.take_in(0, std::reduce(counts.begin(), counts.end()));
}

Result<std::size_t> MergeStream::read(std::span<Key> keys, std::span<std::byte> rows) {
  if (next_ == round_.size()) PSS_TRY(merge_round());
  return round_.read(next_, keys, rows);
}

std::size_t merge_run_points(const Schema& schema, std::size_t runs, std::uint64_t bytes) {
  const std::size_t wanted = kRoundPoints / std::max<std::size_t>(runs, 1);
  std::size_t points = kRunBlockPoints;
  while (2 * points <= wanted && runs * merge_source_memory(schema, 2 * points) <= bytes)
    points *= 2;
  return points;
}

std::uint64_t merge_source_memory(const Schema& schema, std::size_t run_points) {
  constexpr std::uint64_t kFileAndPages = 4096;
  const std::uint64_t row = schema.row_size();
  return (run_points + kRunBlockPoints) * (sizeof(Key) + row) +
         run_points * (Chunk::bytes_per_point(row) + Chunk::sort_bytes_per_point()) + kFileAndPages;
}

std::uint64_t merge_decode_memory(const Schema& schema) {
  // The blocks read, and of those in work the positions, their offsets and planes.
  const std::uint64_t row = sizeof(Index3) + schema.row_size();
  const std::uint64_t working = 3 * sizeof(Index3) + schema.row_size();
  return kRunBlockPoints *
         (slots_in_order() * row + static_cast<std::uint64_t>(thread_count()) * working);
}

}  // namespace pss
