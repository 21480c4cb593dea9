#include "stream/passes/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace pss {
namespace {

/// Copies n records of `size` bytes between rows of different lengths.
void copy_strided(const std::byte* from, std::size_t from_stride, std::byte* to,
                  std::size_t to_stride, std::size_t size, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) std::memcpy(to + i * to_stride, from + i * from_stride, size);
}

Error no_columns(const Store& columns, const Store& store, std::uint64_t source) {
  return {Fault::kBadInput, fmt::format("{}: has no columns for the rows of tile {} of {}",
                                        columns.path(), source, store.path())};
}

/// The number of the tile that was made of the source's tile `source`, or that of its end.
std::size_t made_of(const Store& columns, std::uint64_t source) {
  const auto tiles = columns.tiles();
  const auto found = std::ranges::lower_bound(tiles, source, {}, &TileInfo::source);
  const bool there = found != tiles.end() && found->source == source;
  return there ? static_cast<std::size_t>(found - tiles.begin()) : tiles.size();
}

}  // namespace

Source::Source(const Store& store)
    : store_(&store), exclusion_(store.header().schema), schema_(store.header().schema) {}

Result<void> Source::join(const Store& columns) {
  for (const TileInfo& tile : columns.tiles())
    if (tile.source >= tiles().size() || tile.count != tiles()[tile.source].count)
      return no_columns(columns, *store_, tile.source);
  joined_.push_back({&columns, schema_.fields().size(), schema_.row_size()});
  std::vector<Field> fields = schema_.fields();
  for (const Field& field : columns.header().schema.fields()) fields.push_back(field);
  schema_ = Schema(std::move(fields));
  return {};
}

Result<Source::Place> Source::find(const Joined& joined, std::size_t tile,
                                   const BlockInfo& block) const {
  const std::size_t number = made_of(*joined.store, tile);
  if (number == joined.store->tiles().size()) return no_columns(*joined.store, *store_, tile);
  PSS_ASSIGN(std::vector<BlockInfo> blocks, joined.store->read_index(number));
  const std::uint64_t first =
      block.first_row - tiles()[tile].first_row + joined.store->tiles()[number].first_row;
  const auto found = std::ranges::find(blocks, first, &BlockInfo::first_row);
  if (found == blocks.end() || found->count != block.count)
    return no_columns(*joined.store, *store_, tile);
  return Place{number, std::move(*found)};
}

Result<void> Source::read_field(std::size_t tile, const BlockInfo& block, std::size_t field,
                                std::span<std::byte> out) const {
  const auto from =
      std::ranges::find_if(joined_.rbegin(), joined_.rend(),
                           [&](const Joined& joined) { return joined.first_field <= field; });
  if (from == joined_.rend()) return store_->read_field(tiles()[tile], block, field, out);
  PSS_ASSIGN(const Place place, find(*from, tile, block));
  return from->store->read_field(from->store->tiles()[place.tile], place.block,
                                 field - from->first_field, out);
}

Result<void> Source::read_rows(std::size_t tile, const BlockInfo& block,
                               std::span<std::byte> out) const {
  if (joined_.empty()) return store_->read_rows(tiles()[tile], block, out);
  const std::size_t size = store_->header().schema.row_size();
  std::vector<std::byte> rows(block.count * size);
  PSS_TRY(store_->read_rows(tiles()[tile], block, rows));
  copy_strided(rows.data(), size, out.data(), schema_.row_size(), size, block.count);
  for (const Joined& joined : joined_) PSS_TRY(add_rows(joined, tile, block, out));
  return {};
}

Result<void> Source::add_rows(const Joined& joined, std::size_t tile, const BlockInfo& block,
                              std::span<std::byte> out) const {
  PSS_ASSIGN(const Place place, find(joined, tile, block));
  const std::size_t size = joined.store->header().schema.row_size();
  std::vector<std::byte> rows(block.count * size);
  PSS_TRY(joined.store->read_rows(joined.store->tiles()[place.tile], place.block, rows));
  copy_strided(rows.data(), size, out.data() + joined.position, schema_.row_size(), size,
               block.count);
  return {};
}

Result<void> Source::mark_excluded(std::size_t tile, const BlockInfo& block,
                                   std::span<std::uint8_t> excluded) const {
  return exclusion_.mark(*store_, tiles()[tile], block, excluded);
}

Result<void> Source::read_neighbours(std::size_t tile, const BlockInfo& block,
                                     std::vector<Index3>& positions) const {
  positions.resize(block.count);
  PSS_TRY(read_positions(tile, block, positions));
  if (!excludes_some()) return {};
  std::vector<std::uint8_t> excluded(block.count);
  PSS_TRY(mark_excluded(tile, block, excluded));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!excluded[i]) positions[kept++] = positions[i];
  positions.resize(kept);
  return {};
}

}  // namespace pss
