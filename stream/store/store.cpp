#include "stream/store/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "io/file/hash.h"
#include "stream/store/bytes.h"

namespace pss {
namespace {

/// The end of the last tile's bytes in each segment.
std::vector<std::uint64_t> segment_ends(const Manifest& manifest) {
  std::vector<std::uint64_t> ends(manifest.segments());
  for (const TileInfo& tile : manifest.tiles)
    if (tile.count > 0) ends[tile.segment] = tile.offset + tile.size;
  return ends;
}

/// Takes the next block from a tile's index; its columns begin at `offset` of the segment.
BlockInfo get_block(ByteReader& reader, const Schema& schema, std::uint64_t first_row,
                    std::uint64_t offset) {
  BlockInfo block;
  block.first_row = first_row;
  block.count = reader.get<std::uint32_t>();
  for (std::int64_t& v : block.box.min) v = reader.get<std::int64_t>();
  for (std::int64_t& v : block.box.max) v = reader.get<std::int64_t>();
  if (block.count == 0 || block.count > kBlockPoints) reader.fail();
  block.columns.resize(1 + schema.fields().size());
  for (std::size_t c = 0; c < block.columns.size(); ++c) {
    ColumnInfo& column = block.columns[c];
    column.offset = offset;
    column.size = reader.get<std::uint32_t>();
    column.hash = reader.get<std::uint64_t>();
    offset += column.size;
    if (column.size > column_limit(schema, c, block.count)) reader.fail();
  }
  return block;
}

bool inside(const IndexBox& inner, const IndexBox& outer) {
  for (std::size_t a = 0; a < 3; ++a)
    if (inner.min[a] < outer.min[a] || inner.max[a] > outer.max[a] || inner.min[a] > inner.max[a])
      return false;
  return true;
}

/// The blocks of a tile's index, or nothing where they do not add up to the tile.
std::optional<std::vector<BlockInfo>> parse_index(std::span<const std::byte> bytes,
                                                  const TileInfo& tile, const Schema& schema) {
  ByteReader reader(bytes);
  std::vector<BlockInfo> blocks;
  std::uint64_t row = tile.first_row;
  std::uint64_t offset = tile.offset;
  for (std::uint32_t b = 0; b < tile.blocks && reader.ok(); ++b) {
    blocks.push_back(get_block(reader, schema, row, offset));
    const BlockInfo& block = blocks.back();
    if (!inside(block.box, tile.box)) reader.fail();
    row += block.count;
    offset = block.columns.back().offset + block.columns.back().size;
  }
  const bool good = reader.finished() && row == tile.first_row + tile.count &&
                    offset + tile.index_size == tile.offset + tile.size;
  return good ? std::optional(std::move(blocks)) : std::nullopt;
}

/// Opens a file of a store that has so many bytes, or more where the store may still grow.
Result<File> open_whole(const std::string& path, std::uint64_t expected, bool finished) {
  if (!exists(path))
    return Error{Fault::kBadInput,
                 fmt::format("{}: damaged: found no such file, expected {} bytes; copy the store "
                             "again, or build it again",
                             path, expected)};
  PSS_ASSIGN(File file, File::open(path));
  PSS_ASSIGN(const std::uint64_t size, file.size());
  if (size < expected || (finished && size > expected))
    return Error{Fault::kBadInput,
                 fmt::format("{}: damaged at offset {}: {} bytes found, {} expected", path,
                             std::min(size, expected), size, expected)};
  return file;
}

}  // namespace

Result<Store> Store::open(const std::string& path) {
  Store store;
  store.path_ = path;
  if (!is_store(path))
    return Error{exists(path) ? Fault::kBadInput : Fault::kFailed,
                 fmt::format("{}: found no store, expected a directory made by pss tile", path)};
  if (exists(manifest_path(path))) {
    PSS_ASSIGN(store.record_, fingerprint(manifest_path(path)));
  }
  if (auto opened = store.open_files(); !opened) return store.changed_or(opened.error());
  return store;
}

Result<void> Store::open_files() {
  const bool finished = record_.has_value();
  const std::string log = finished ? record_->path : open_manifest_path(path_);
  PSS_ASSIGN(manifest_size_,
             read_log(log, finished ? Tail::kWhole : Tail::kMayBeTorn,
                      [&](const LogRecord& record) { return manifest_.add(log, record); }));
  if (!manifest_.has_header || (finished && !manifest_.complete))
    return Error{Fault::kBadInput, fmt::format("{}: damaged at offset {}: the {} record is missing",
                                               log, manifest_size_, finished ? "end" : "header")};
  PSS_TRY(check_inputs());
  return open_segments();
}

/// The table of inputs is read when it is needed: here it only is there, from end to end.
Result<void> Store::check_inputs() const {
  if (!complete() || header().inputs.count == 0) return {};
  PSS_ASSIGN(const File file, open_whole(inputs_path(path_), manifest_.input_bytes, true));
  return {};
}

Result<InputTable> Store::inputs() const {
  auto table = InputTable::open(path_, header().inputs.count);
  if (!table) return changed_or(table.error());
  return table;
}

/// A store that another one replaces while it is read looks damaged.
Error Store::changed_or(Error error) const {
  return record_ ? change_or(std::move(error), *record_) : std::move(error);
}

Result<void> Store::open_segments() {
  const auto ends = segment_ends(manifest_);
  segments_ = std::make_unique<SegmentFiles>(path_, most_open_segments());
  for (std::uint32_t n = 0; n < ends.size(); ++n) {
    PSS_ASSIGN(File file, open_whole(segment_path(path_, n), ends[n], complete()));
    segments_->keep(n, std::move(file));
  }
  return {};
}

std::uint64_t Store::bytes_on_disk() const {
  std::uint64_t bytes = manifest_size_ + manifest_.input_bytes;
  for (const TileInfo& tile : manifest_.tiles) bytes += tile.size;
  return bytes;
}

std::uint64_t Store::table_memory() const {
  std::uint64_t bytes = manifest_.tiles.capacity() * sizeof(TileInfo);
  for (const TileInfo& tile : manifest_.tiles) bytes += tile.note.bytes.capacity();
  return bytes;
}

Error Store::damaged(const TileInfo& tile, std::uint64_t offset, const std::string& what) const {
  return changed_or(
      {Fault::kBadInput, fmt::format("{}: damaged at offset {}: {} (tile of rows {} to {})",
                                     segment_path(path_, tile.segment), offset, what,
                                     tile.first_row, tile.first_row + tile.count)});
}

Result<void> Store::read_segment(const TileInfo& tile, std::uint64_t offset,
                                 std::span<std::byte> out) const {
  if (auto read = segments_->read(tile.segment, offset, out); !read)
    return changed_or(read.error());
  return {};
}

Result<std::vector<BlockInfo>> Store::read_index(std::size_t number) const {
  const TileInfo& tile = manifest_.tiles[number];
  if (tile.count == 0) return std::vector<BlockInfo>();
  const std::uint64_t offset = tile.offset + tile.size - tile.index_size;
  std::vector<std::byte> bytes(tile.index_size);
  PSS_TRY(read_segment(tile, offset, bytes));
  if (hash64(bytes) != tile.index_hash)
    return damaged(
        tile, offset,
        fmt::format("the {} bytes of the block index do not match their checksum", bytes.size()));
  auto blocks = parse_index(bytes, tile, header().schema);
  if (!blocks) return damaged(tile, offset, "the block index does not add up to its tile");
  return std::move(*blocks);
}

Result<void> Store::check_column(const TileInfo& tile, const ColumnInfo& column,
                                 std::span<const std::byte> bytes) const {
  if (hash64(bytes) == column.hash) return {};
  return damaged(tile, column.offset,
                 fmt::format("the {} bytes of a column do not match their checksum", bytes.size()));
}

Result<std::vector<std::byte>> Store::read_column(const TileInfo& tile,
                                                  const ColumnInfo& column) const {
  std::vector<std::byte> bytes(column.size);
  PSS_TRY(read_segment(tile, column.offset, bytes));
  PSS_TRY(check_column(tile, column, bytes));
  return bytes;
}

Result<void> Store::check_bytes(std::size_t number) const {
  PSS_ASSIGN(const std::vector<BlockInfo> blocks, read_index(number));
  for (const BlockInfo& block : blocks)
    for (const ColumnInfo& column : block.columns)
      if (auto read = read_column(manifest_.tiles[number], column); !read) return read.error();
  return {};
}

Result<void> Store::read_positions(const TileInfo& tile, const BlockInfo& block,
                                   std::span<Index3> out) const {
  assert(out.size() == block.count);
  PSS_ASSIGN(const auto bytes, read_column(tile, block.columns[0]));
  if (!decode_positions(bytes, out) || box_of(out) != block.box)
    return damaged(tile, block.columns[0].offset, "the positions are not those of their box");
  return {};
}

Result<void> Store::read_field(const TileInfo& tile, const BlockInfo& block, std::size_t field,
                               std::span<std::byte> out) const {
  const Field& f = header().schema.fields()[field];
  assert(out.size() == block.count * f.size());
  PSS_ASSIGN(const auto bytes, read_column(tile, block.columns[1 + field]));
  if (!decode_field(f, bytes, block.count, out.data(), f.size()))
    return damaged(tile, block.columns[1 + field].offset, "the column is not of its field");
  return {};
}

Result<void> Store::read_rows(const TileInfo& tile, const BlockInfo& block,
                              std::span<std::byte> out) const {
  const Schema& schema = header().schema;
  assert(out.size() == block.count * schema.row_size());
  if (schema.fields().empty()) return {};
  // The columns lie behind each other: one read gets them all.
  const std::uint64_t start = block.columns[1].offset;
  const ColumnInfo& last = block.columns.back();
  std::vector<std::byte> bytes(last.offset + last.size - start);
  PSS_TRY(read_segment(tile, start, bytes));
  for (std::size_t f = 0; f < schema.fields().size(); ++f) {
    const ColumnInfo& column = block.columns[1 + f];
    const auto part = std::span(bytes).subspan(column.offset - start, column.size);
    PSS_TRY(check_column(tile, column, part));
    if (!decode_field(schema.fields()[f], part, block.count, out.data() + schema.position(f),
                      schema.row_size()))
      return damaged(tile, column.offset, "the column is not of its field");
  }
  return {};
}

std::vector<std::byte> encode_index(std::span<const BlockInfo> blocks) {
  std::vector<std::byte> out;
  ByteWriter writer(out);
  for (const BlockInfo& block : blocks) {
    writer.put(block.count);
    for (const std::int64_t v : block.box.min) writer.put(v);
    for (const std::int64_t v : block.box.max) writer.put(v);
    for (const ColumnInfo& column : block.columns) {
      writer.put(column.size);
      writer.put(column.hash);
    }
  }
  return out;
}

}  // namespace pss
