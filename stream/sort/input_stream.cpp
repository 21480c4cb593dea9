#include "stream/sort/input_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/parallel.h"
#include "io/points/positions.h"

namespace pss {
namespace {

template <class T>
void store_at(std::byte* row, std::size_t position, T value) {
  std::memcpy(row + position, &value, sizeof value);
}

bool finite(const World3& p) {
  return std::ranges::all_of(p, [](double v) { return std::isfinite(v); });
}

Error interrupted() { return {Fault::kInterrupted, "stopped while reading points"}; }

std::optional<std::size_t> position_of(const Schema& schema, const char* name) {
  const auto field = schema.find(name);
  return field ? std::optional(schema.position(*field)) : std::nullopt;
}

}  // namespace

InputStream::InputStream(const IngestPlan& plan, bool source_column, const Cursor& from,
                         const IngestSummary& summary, std::vector<InputCounts> counts)
    : plan_(plan), cursor_(from), summary_(summary), counts_(std::move(counts)) {
  counts_.resize(plan.inputs.size());
  if (!source_column) return;
  source_file_ = position_of(plan.header.schema, kSourceFile);
  source_record_ = position_of(plan.header.schema, kSourceRecord);
}

Result<void> InputStream::open_input() {
  PSS_ASSIGN(reader_, plan_.open(record(), HeadBytes::kLeft, plan_.counts[cursor_.input]));
  mapper_.emplace(reader_->header().schema, plan_.header.schema);
  placement_.emplace(reader_->header().grid, plan_.header.lattice);
  batches_.clear();
  if (cursor_.record > 0) PSS_TRY(reader_->seek(cursor_.record));
  return {};
}

Result<void> InputStream::read(std::size_t most, const Batches& batches, Chunk& chunk,
                               const Monitor& monitor) {
  if (ended()) return {};
  if (!reader_) PSS_TRY(open_input());
  if (batches_.size() != batches.count) batches_.assign(batches.count, {});
  const auto batch = [&](std::size_t k) -> Batch& { return batches_[k % batches_.size()]; };
  const std::size_t first = chunk.size();
  std::size_t fetched = 0;
  bool at_end = false;
  Result<void> fetch, result;
  const auto take = [&](std::size_t k) {
    const std::size_t room = most - fetched;
    // A unit that does not fit whole is left to the next call, unless this one would read nothing.
    if (room == 0 || (fetched > 0 && room < reader_->unit())) return false;
    fetch = monitor.stopping() ? interrupted()
                               : reader_->fetch(std::min(batches.points, room), batch(k).raw);
    if (!fetch) return false;
    at_end = batch(k).raw.count == 0;
    batch(k).at = first + fetched;
    fetched += batch(k).raw.count;
    return !at_end;
  };
  const auto give = [&](std::size_t k) {
    result = batch(k).result;
    if (!result) return false;
    chunk.take_in(batch(k).at, batch(k).kept);
    count(batch(k));
    return true;
  };
  parallel_in_order(
      batches_.size(), take, [&](std::size_t k) { prepare(batch(k), chunk); }, give);
  // First what became of the records before those that could not be fetched.
  if (!result) return change_or(result.error(), record());
  PSS_TRY(fetch);
  if (!at_end) return {};
  reader_.reset();
  cursor_ = {cursor_.input + 1, 0};
  return {};
}

Result<void> InputStream::check_input() const {
  return ended() ? Result<void>() : check_unchanged(record());
}

Result<void> InputStream::seek(const Cursor& to) {
  if (to.input != cursor_.input) reader_.reset();
  cursor_ = to;
  return reader_ ? reader_->seek(to.record) : Result<void>();
}

void InputStream::prepare(Batch& batch, const Chunk& chunk) const {
  reader_->decode(batch.raw);
  const PointBatch& points = batch.raw.points;
  const auto rows = chunk.row_places(batch.at, batch.raw.count);
  mapper_->map(points.rows, rows);
  write_sources(points, rows);
  batch.result = place(batch, chunk.key_places(batch.at, batch.raw.count), rows);
}

void InputStream::write_sources(const PointBatch& points, std::span<std::byte> rows) const {
  if (!source_file_ || !source_record_) return;
  const std::size_t row_size = plan_.header.schema.row_size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::byte* row = rows.data() + i * row_size;
    store_at(row, *source_file_, static_cast<std::uint32_t>(cursor_.input));
    store_at(row, *source_record_, points.first_record + i);
  }
}

/// Whether the point lies outside the box that is kept; one that is not finite lies nowhere.
bool InputStream::dropped_outside(const PointBatch& points, std::size_t i) const {
  if (!plan_.drop_outside) return false;
  const World3 world = world_position(points, reader_->header().grid, i);
  return finite(world) && !plan_.drop_outside->contains(world);
}

/// Makes the keys; points that are dropped make room for those behind them.
Result<void> InputStream::place(Batch& batch, std::span<Key> keys,
                                std::span<std::byte> rows) const {
  const std::size_t row_size = plan_.header.schema.row_size();
  batch.kept = batch.moved = batch.outside = 0;
  batch.largest_move = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (dropped_outside(batch.raw.points, i)) {
      ++batch.outside;
      continue;
    }
    Index3 index{};
    double move = 0;
    const Placed placed = placement_->place(batch.raw.points, i, index, move);
    if (placed == Placed::kOutside) return outside(batch.raw.points, i);
    if (placed == Placed::kNotFinite) continue;
    batch.moved += placed == Placed::kMoved ? 1 : 0;
    batch.largest_move = std::max(batch.largest_move, move);
    if (batch.kept < i)
      copy_row(rows.data() + batch.kept * row_size, rows.data() + i * row_size, row_size);
    keys[batch.kept++] = encode_key(index);
  }
  return {};
}

void InputStream::count(const Batch& batch) {
  const std::uint64_t not_finite = batch.raw.count - batch.kept - batch.outside;
  summary_.points_read += batch.raw.count;
  summary_.dropped_not_finite += not_finite;
  summary_.dropped_outside += batch.outside;
  summary_.moved_to_lattice += batch.moved;
  InputCounts& counts = counts_[cursor_.input];
  counts.read += batch.raw.count;
  counts.not_finite += not_finite;
  counts.outside += batch.outside;
  counts.moved += batch.moved;
  summary_.largest_move = std::max(summary_.largest_move, batch.largest_move);
  cursor_.record = batch.raw.points.first_record + batch.raw.count;
}

Error InputStream::outside(const PointBatch& points, std::size_t i) const {
  const Lattice& lattice = plan_.header.lattice;
  const World3 world = world_position(points, reader_->header().grid, i);
  return {Fault::kBadInput,
          fmt::format("{}: record {}: the position ({:.17g}, {:.17g}, {:.17g}) lies outside the "
                      "bounds that the file promised: {} bits of steps of {} from {} do not reach "
                      "it; give a coarser --scale",
                      record().path, points.first_record + i, world[0], world[1], world[2],
                      kLatticeBits, lattice.scale[0], lattice.origin[0])};
}

std::uint64_t input_memory(const Schema& schema, const Batches& batches) {
  // Each as it lies in the file and decoded.
  return std::uint64_t{2} * batches.count * batches.points * (sizeof(Index3) + schema.row_size());
}

}  // namespace pss
