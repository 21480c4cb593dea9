#include "stream/store/manifest.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/file/file.h"
#include "stream/store/block.h"
#include "stream/store/bytes.h"

namespace pss {
namespace {

Note get_note(ByteReader& r) {
  Note note;
  note.version = r.get<std::uint32_t>();
  const auto bytes = r.bytes();
  note.bytes.assign(bytes.begin(), bytes.end());
  return note;
}

void put(ByteWriter& w, const Note& note) {
  w.put(note.version);
  w.bytes(note.bytes);
}

void put(ByteWriter& w, const IndexBox& box) {
  for (const std::int64_t v : box.min) w.put(v);
  for (const std::int64_t v : box.max) w.put(v);
}

IndexBox get_box(ByteReader& r) {
  IndexBox box;
  for (std::int64_t& v : box.min) v = r.get<std::int64_t>();
  for (std::int64_t& v : box.max) v = r.get<std::int64_t>();
  for (std::size_t a = 0; a < 3; ++a)
    if (box.min[a] > box.max[a]) r.fail();
  if (!on_lattice(box.min) || !on_lattice(box.max)) r.fail();
  return box;
}

Cell get_cell(ByteReader& r) {
  Cell cell;
  cell.first.high = r.get<std::uint64_t>();
  cell.first.low = r.get<std::uint64_t>();
  cell.level = r.get<std::uint8_t>();
  if (cell.level > kLatticeBits || cell_of(cell.first, cell.level) != cell) r.fail();
  if ((cell.first.high | cell.first.low) >> 63 != 0) r.fail();
  return cell;
}

TileInfo get_tile(ByteReader& r) {
  TileInfo tile;
  tile.source = r.get<std::uint64_t>();
  tile.cell = get_cell(r);
  tile.count = r.get<std::uint64_t>();
  if (tile.count > 0) tile.box = get_box(r);
  tile.blocks = r.get<std::uint32_t>();
  tile.segment = r.get<std::uint32_t>();
  tile.offset = r.get<std::uint64_t>();
  tile.size = r.get<std::uint64_t>();
  tile.index_size = r.get<std::uint32_t>();
  tile.index_hash = r.get<std::uint64_t>();
  tile.note = get_note(r);
  return tile;
}

/// Whether the tile lies right after `previous` (null: it is the first) in the segments.
bool follows(const TileInfo& tile, const TileInfo* previous) {
  if (!previous) return tile.segment == 0 && tile.offset == 0;
  if (tile.segment == previous->segment) return tile.offset == previous->offset + previous->size;
  return tile.segment == previous->segment + 1 && tile.offset == 0;
}

/// Whether the tile's counts and sizes go together: all of them are 0, or none is.
bool plausible(const TileInfo& tile, const StoreHeader& header) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
  if (tile.source >= kMost || tile.offset >= kMost) return false;
  if (tile.count == 0) return tile.blocks == 0 && tile.size == 0 && tile.index_size == 0;
  return tile.count <= header.tile_points && tile.blocks > 0 && tile.blocks <= tile.count &&
         tile.index_size == tile.blocks * index_entry_size(header.schema) &&
         tile.size > tile.index_size && tile.size < kMost;
}

Error damaged(const std::string& path, std::uint64_t offset, const std::string& what) {
  return {Fault::kBadInput, fmt::format("{}: damaged at offset {}: {}", path, offset, what)};
}

Result<void> add_header(Manifest& m, const std::string& path, const LogRecord& record) {
  PSS_ASSIGN(m.header, decode_header(path, record.offset, record.payload));
  m.producer = producer_in(record.payload);
  m.has_header = true;
  return {};
}

Result<void> add_tile(Manifest& m, const std::string& path, const LogRecord& record) {
  ByteReader reader(record.payload);
  TileInfo tile = get_tile(reader);
  const TileInfo* previous = m.tiles.empty() ? nullptr : &m.tiles.back();
  tile.first_row = m.points();
  const bool good = reader.finished() && plausible(tile, m.header) && follows(tile, previous) &&
                    tile.source >= m.next_source() &&
                    (!previous || previous->cell.first <= tile.cell.first);
  if (!good)
    return damaged(path, record.offset,
                   fmt::format("the record of tile {} makes no sense", m.tiles.size()));
  m.tiles.push_back(std::move(tile));
  return {};
}

Result<void> add_end(Manifest& m, const std::string& path, const LogRecord& record) {
  ByteReader reader(record.payload);
  const auto tiles = reader.get<std::uint64_t>();
  const auto points = reader.get<std::uint64_t>();
  m.input_bytes = reader.get<std::uint64_t>();
  m.note = get_note(reader);
  m.summary = reader.text();
  if (!reader.finished() || tiles != m.tiles.size() || points != m.points())
    return damaged(path, record.offset,
                   fmt::format("{} tiles of {} points found, the end record says {} of {}",
                               m.tiles.size(), m.points(), tiles, points));
  m.complete = true;
  return {};
}

}  // namespace

std::vector<std::byte> encode_tile(const TileInfo& tile) {
  std::vector<std::byte> out;
  ByteWriter w(out);
  w.put(tile.source);
  w.put(tile.cell.first.high);
  w.put(tile.cell.first.low);
  w.put(static_cast<std::uint8_t>(tile.cell.level));
  w.put(tile.count);
  if (tile.count > 0) put(w, tile.box);
  w.put(tile.blocks);
  w.put(tile.segment);
  w.put(tile.offset);
  w.put(tile.size);
  w.put(tile.index_size);
  w.put(tile.index_hash);
  put(w, tile.note);
  return out;
}

std::vector<std::byte> encode_end(const Manifest& manifest) {
  std::vector<std::byte> out;
  ByteWriter w(out);
  w.put(static_cast<std::uint64_t>(manifest.tiles.size()));
  w.put(manifest.points());
  w.put(manifest.input_bytes);
  put(w, manifest.note);
  w.text(manifest.summary);
  return out;
}

std::size_t index_entry_size(const Schema& schema) {
  constexpr std::size_t kColumn = sizeof(std::uint32_t) + sizeof(std::uint64_t);
  return sizeof(std::uint32_t) + 6 * sizeof(std::int64_t) + (1 + schema.fields().size()) * kColumn;
}

std::uint64_t Manifest::points() const {
  return tiles.empty() ? 0 : tiles.back().first_row + tiles.back().count;
}

std::uint64_t Manifest::next_source() const { return tiles.empty() ? 0 : tiles.back().source + 1; }

std::uint32_t Manifest::segments() const {
  const auto last = std::ranges::find_if(tiles.rbegin(), tiles.rend(),
                                         [](const TileInfo& tile) { return tile.count > 0; });
  return last == tiles.rend() ? 0 : last->segment + 1;
}

Result<void> Manifest::add(const std::string& path, const LogRecord& record) {
  const auto type = static_cast<RecordType>(record.type);
  if (complete) return damaged(path, record.offset, "a record follows the end record");
  if ((type == RecordType::kHeader) == has_header)
    return damaged(path, record.offset, "the header is not the first record");
  if (type == RecordType::kHeader) return add_header(*this, path, record);
  if (type == RecordType::kTile) return add_tile(*this, path, record);
  if (type == RecordType::kEnd) return add_end(*this, path, record);
  return damaged(path, record.offset, fmt::format("record type {} is unknown", record.type));
}

std::string manifest_path(const std::string& store) { return store + "/manifest"; }

std::string open_manifest_path(const std::string& store) { return store + "/manifest.log"; }

std::string segment_path(const std::string& store, std::uint32_t number) {
  return fmt::format("{}/segment-{:06}", store, number);
}

bool is_store(const std::string& path) {
  return exists(manifest_path(path)) || exists(open_manifest_path(path));
}

bool has_manifest(const std::string& store) {
  bool header = false;
  for (const std::string& path : {manifest_path(store), open_manifest_path(store)}) {
    if (!exists(path)) continue;
    // Whatever comes after it, and whichever version it is of: the log's checksums tell.
    static_cast<void>(read_log(path, Tail::kMayBeTorn, [&](const LogRecord& record) {
      header = header || static_cast<RecordType>(record.type) == RecordType::kHeader;
      return Result<void>(Error{Fault::kFailed, "seen"});
    }));
  }
  return header;
}

}  // namespace pss
