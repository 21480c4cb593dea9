#include "stream/merge.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"

namespace pss {
namespace {

/// Longer rounds gain nothing: they leave the caches.
constexpr std::size_t kRoundPoints = 1 << 18;

std::size_t decoded_at_once() { return 2 * static_cast<std::size_t>(thread_count()); }

}  // namespace

MergeStream::MergeStream(std::size_t runs, std::size_t run_points, std::size_t row_size,
                         const Monitor& monitor)
    : run_points_(run_points),
      row_size_(row_size),
      monitor_(&monitor),
      round_(runs * run_points, row_size) {
  sources_.reserve(runs);
}

Result<MergeStream> MergeStream::open(const std::string& folder, std::span<const RunInfo> runs,
                                      const Schema& schema, const std::optional<Key>& from,
                                      std::size_t run_points, const Monitor& monitor) {
  MergeStream merge(runs.size(), run_points, schema.row_size(), monitor);
  for (const RunInfo& run : runs) {
    PSS_ASSIGN(RunReader reader, RunReader::open(folder, run, schema));
    Source& source = merge.sources_.emplace_back(Source{std::move(reader), {}, 0});
    source.points.row_size = schema.row_size();
    source.points.keys.reserve(run_points + kRunBlockPoints);
    source.points.rows.reserve((run_points + kRunBlockPoints) * schema.row_size());
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
      const auto& keys = source.points.keys;
      source.at = static_cast<std::size_t>(std::ranges::lower_bound(keys, from) - keys.begin());
      behind = behind || (source.left() == 0 && !source.reader.ended());
    }
  }
  return {};
}

/// Decodes blocks until every run has the points of a round, or no more.
Result<void> MergeStream::refill() {
  std::vector<Arrival> arrivals;
  for (std::size_t s = 0; s < sources_.size(); ++s) PSS_TRY(refill(s, arrivals));
  return decode(arrivals);
}

Result<void> MergeStream::refill(std::size_t s, std::vector<Arrival>& arrivals) {
  Source& source = sources_[s];
  if (source.left() >= run_points_ || source.reader.ended()) return {};
  const auto merged = static_cast<std::ptrdiff_t>(source.at);
  source.points.keys.erase(source.points.keys.begin(), source.points.keys.begin() + merged);
  source.points.rows.erase(
      source.points.rows.begin(),
      source.points.rows.begin() + merged * static_cast<std::ptrdiff_t>(row_size_));
  source.at = 0;
  while (source.points.size() < run_points_ && !source.reader.ended()) {
    Arrival& arrival = arrivals.emplace_back(Arrival{s, source.points.size(), {}});
    PSS_TRY(source.reader.next(arrival.block));
    source.points.keys.resize(arrival.at + arrival.block.count);
    source.points.rows.resize(source.points.keys.size() * row_size_);
    if (arrivals.size() == decoded_at_once()) PSS_TRY(decode(arrivals));
  }
  return {};
}

Result<void> MergeStream::decode(std::vector<Arrival>& arrivals) {
  std::vector<Result<void>> done(arrivals.size());
  parallel_for(arrivals.size(), 1, [&](std::size_t i, std::size_t) {
    const Arrival& arrival = arrivals[i];
    Source& source = sources_[arrival.source];
    const std::size_t count = arrival.block.count;
    done[i] = source.reader.decode(
        arrival.block, std::span(source.points.keys).subspan(arrival.at, count),
        std::span(source.points.rows).subspan(arrival.at * row_size_, count * row_size_));
  });
  arrivals.clear();
  for (Result<void>& result : done) PSS_TRY(std::move(result));
  return {};
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
      if (!before(source.points.keys[last(source)], source.points.row(last(source)),
                  b.points.keys[last(b)], b.points.row(last(b)), row_size_))
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
    const bool after = before(bound.points.keys[last], bound.points.row(last),
                              source.points.keys[i], source.points.row(i), row_size_);
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
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    Source& source = sources_[s];
    round_.add(std::span(source.points.keys).subspan(source.at, counts[s]),
               std::span(source.points.rows).subspan(source.at * row_size_, counts[s] * row_size_));
    source.at += counts[s];
  }
  return round_.sort(*monitor_);
}

Result<void> MergeStream::read(std::size_t max, KeyedRows& out) {
  if (next_ == round_.size()) PSS_TRY(merge_round());
  round_.read(next_, max, out);
  return {};
}

std::size_t merge_run_points(const Schema& schema, std::size_t runs, std::uint64_t bytes) {
  const std::size_t wanted = kRoundPoints / std::max<std::size_t>(runs, 1);
  std::size_t points = kRunBlockPoints;
  while (2 * points <= wanted && runs * merge_source_memory(schema, 2 * points) <= bytes)
    points *= 2;
  return points;
}

std::uint64_t merge_source_memory(const Schema& schema, std::size_t run_points) {
  constexpr std::uint64_t kFileAndVectors = 1024;
  const std::uint64_t row = schema.row_size();
  return (run_points + kRunBlockPoints) * (sizeof(Key) + row) +
         run_points * (Chunk::bytes_per_point(row) + Chunk::sort_bytes_per_point()) +
         kFileAndVectors;
}

std::uint64_t merge_decode_memory(const Schema& schema) {
  // The blocks read, and of those in work the positions, their offsets and planes.
  const std::uint64_t row = sizeof(Index3) + schema.row_size();
  const std::uint64_t working = 3 * sizeof(Index3) + schema.row_size();
  return kRunBlockPoints *
         (decoded_at_once() * row + static_cast<std::uint64_t>(thread_count()) * working);
}

}  // namespace pss
