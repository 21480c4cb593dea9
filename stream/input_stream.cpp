#include "stream/input_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/parallel.h"

namespace pss {
namespace {

constexpr std::size_t kGrain = 4096;

template <class T>
void store_at(std::byte* row, std::size_t position, T value) {
  std::memcpy(row + position, &value, sizeof value);
}

std::optional<std::size_t> position_of(const Schema& schema, const char* name) {
  const auto field = schema.find(name);
  return field ? std::optional(schema.position(*field)) : std::nullopt;
}

}  // namespace

InputStream::InputStream(const IngestPlan& plan, bool source_column, const Cursor& from,
                         const IngestSummary& summary)
    : plan_(plan), cursor_(from), summary_(summary) {
  if (!source_column) return;
  source_file_ = position_of(plan.header.schema, kSourceFile);
  source_record_ = position_of(plan.header.schema, kSourceRecord);
}

Result<void> InputStream::open_input() {
  PSS_ASSIGN(reader_, open_reader(plan_.inputs[cursor_.input]));
  mapper_.emplace(reader_->header().schema, plan_.header.schema);
  placement_.emplace(reader_->header().grid, plan_.header.lattice);
  if (cursor_.record > 0) PSS_TRY(reader_->seek(cursor_.record));
  return {};
}

Result<void> InputStream::read(std::size_t max, KeyedRows& out) {
  out.clear();
  out.row_size = plan_.header.schema.row_size();
  if (ended()) return {};
  if (!reader_) PSS_TRY(open_input());
  PSS_TRY(reader_->read(max, batch_));
  if (batch_.size() == 0) {
    reader_.reset();
    cursor_ = {cursor_.input + 1, 0};
    return {};
  }
  PSS_TRY(place(out));
  map_rows(out);
  write_sources(out);
  drop_not_finite(out);
  summary_.points_read += batch_.size();
  cursor_.record = batch_.first_record + batch_.size();
  return {};
}

Result<void> InputStream::seek(const Cursor& to) {
  if (to.input != cursor_.input) reader_.reset();
  cursor_ = to;
  return reader_ ? reader_->seek(to.record) : Result<void>();
}

Result<void> InputStream::place(KeyedRows& out) {
  const std::size_t n = batch_.size();
  out.keys.resize(n);
  placed_.resize(n);
  moves_.resize(n);
  parallel_for(n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Index3 index{};
      placed_[i] = placement_->place(batch_, i, index, moves_[i]);
      if (placed_[i] == Placed::kExact || placed_[i] == Placed::kMoved)
        out.keys[i] = encode_key(index);
    }
  });
  for (std::size_t i = 0; i < n; ++i) {
    if (placed_[i] == Placed::kOutside) return outside(i);
    summary_.moved_to_lattice += placed_[i] == Placed::kMoved ? 1 : 0;
    summary_.largest_move = std::max(summary_.largest_move, moves_[i]);
  }
  return {};
}

void InputStream::map_rows(KeyedRows& out) {
  const std::size_t from = reader_->header().schema.row_size();
  const std::size_t to = out.row_size;
  out.rows.resize(batch_.size() * to);
  parallel_for(batch_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    mapper_->map(std::span(batch_.rows).subspan(begin * from, (end - begin) * from),
                 std::span(out.rows).subspan(begin * to, (end - begin) * to));
  });
}

void InputStream::write_sources(KeyedRows& out) const {
  if (!source_file_ || !source_record_) return;
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    std::byte* row = out.rows.data() + i * out.row_size;
    store_at(row, *source_file_, static_cast<std::uint32_t>(cursor_.input));
    store_at(row, *source_record_, batch_.first_record + i);
  }
}

void InputStream::drop_not_finite(KeyedRows& out) {
  const auto first = std::ranges::find(placed_, Placed::kNotFinite);
  if (first == placed_.end()) return;
  std::size_t kept = static_cast<std::size_t>(first - placed_.begin());
  for (std::size_t i = kept; i < placed_.size(); ++i) {
    if (placed_[i] == Placed::kNotFinite) continue;
    out.keys[kept] = out.keys[i];
    if (out.row_size > 0)
      std::memmove(out.rows.data() + kept * out.row_size, out.row(i), out.row_size);
    ++kept;
  }
  summary_.dropped_not_finite += placed_.size() - kept;
  out.keys.resize(kept);
  out.rows.resize(kept * out.row_size);
}

Error InputStream::outside(std::size_t i) const {
  const Lattice& lattice = plan_.header.lattice;
  const World3 world =
      batch_.index.empty() ? batch_.world[i] : to_world(*reader_->header().grid, batch_.index[i]);
  return {Fault::kBadInput,
          fmt::format("{}: record {}: the position ({:.17g}, {:.17g}, {:.17g}) lies outside the "
                      "bounds that the file promised: {} bits of steps of {} from {} do not reach "
                      "it; give a coarser --scale",
                      plan_.inputs[cursor_.input], batch_.first_record + i, world[0], world[1],
                      world[2], kLatticeBits, lattice.scale[0], lattice.origin[0])};
}

std::uint64_t input_bytes_per_point(const Schema& schema) {
  // Position and row as read, key and row as mapped, and what became of them.
  return sizeof(Index3) + schema.row_size() + sizeof(Key) + schema.row_size() + 16;
}

}  // namespace pss
