#include "stream/manifest.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "io/file.h"
#include "stream/block.h"
#include "stream/bytes.h"

namespace pss {
namespace {

constexpr std::uint32_t kFormatVersion = 1;

void put(ByteWriter& w, const Lattice& lattice) {
  for (const double s : lattice.scale) w.put(s);
  for (const double o : lattice.origin) w.put(o);
}

Lattice get_lattice(ByteReader& r) {
  Lattice lattice;
  for (double& s : lattice.scale) s = r.get<double>();
  for (double& o : lattice.origin) o = r.get<double>();
  for (const double s : lattice.scale)
    if (!(s > 0) || !std::isfinite(s)) r.fail();
  for (const double o : lattice.origin)
    if (!std::isfinite(o)) r.fail();
  return lattice;
}

void put(ByteWriter& w, const Field& field) {
  w.text(field.name);
  w.put(static_cast<std::uint8_t>(field.type));
  w.put(field.count);
  w.put(field.scale);
  w.put(field.offset);
  w.put(static_cast<std::uint32_t>(field.bits.size()));
  for (const BitField& bits : field.bits) {
    w.text(bits.name);
    w.put(bits.shift);
    w.put(bits.width);
  }
}

Field get_field(ByteReader& r) {
  Field field;
  field.name = r.text();
  const auto type = r.get<std::uint8_t>();
  if (type > static_cast<std::uint8_t>(Type::kFloat64)) return r.fail(), field;
  field.type = static_cast<Type>(type);
  field.count = r.get<std::uint32_t>();
  if (field.count == 0 || field.count > kMaxRowSize) return r.fail(), field;
  field.scale = r.get<double>();
  field.offset = r.get<double>();
  const std::size_t bits = r.count(6);
  for (std::size_t i = 0; i < bits && r.ok(); ++i) {
    BitField& b = field.bits.emplace_back();
    b.name = r.text();
    b.shift = r.get<std::uint8_t>();
    b.width = r.get<std::uint8_t>();
    if (b.width == 0 || b.shift + b.width > 8 * size_of(field.type) || is_float(field.type))
      r.fail();
  }
  return field;
}

void put(ByteWriter& w, const Schema& schema) {
  w.put(static_cast<std::uint32_t>(schema.fields().size()));
  for (const Field& field : schema.fields()) put(w, field);
}

Schema get_schema(ByteReader& r) {
  const std::size_t count = r.count(29);
  std::vector<Field> fields;
  std::size_t row_size = 0;
  for (std::size_t i = 0; i < count && r.ok(); ++i) {
    fields.push_back(get_field(r));
    row_size += fields.back().size();
    if (row_size > kMaxRowSize) r.fail();
  }
  return r.ok() ? Schema(std::move(fields)) : Schema();
}

void put(ByteWriter& w, const Carry& carry) {
  w.put(static_cast<std::uint8_t>(carry.format));
  w.bytes(carry.head);
  w.bytes(carry.tail);
}

Format get_format(ByteReader& r) {
  const auto format = r.get<std::uint8_t>();
  if (format > static_cast<std::uint8_t>(Format::kText)) return r.fail(), Format::kLas;
  return static_cast<Format>(format);
}

std::vector<std::byte> get_bytes(ByteReader& r) {
  const auto bytes = r.bytes();
  return {bytes.begin(), bytes.end()};
}

Carry get_carry(ByteReader& r) {
  Carry carry;
  carry.format = get_format(r);
  carry.head = get_bytes(r);
  carry.tail = get_bytes(r);
  return carry;
}

void put(ByteWriter& w, const InputRecord& input) {
  w.text(input.path);
  w.put(input.size);
  w.put(input.modified_ns);
  w.put(input.content_hash);
}

InputRecord get_input(ByteReader& r) {
  InputRecord input;
  input.path = r.text();
  input.size = r.get<std::uint64_t>();
  input.modified_ns = r.get<std::int64_t>();
  input.content_hash = r.get<std::uint64_t>();
  return input;
}

/// After the format version.
StoreHeader get_header(ByteReader& r) {
  StoreHeader h;
  h.lattice = get_lattice(r);
  h.schema = get_schema(r);
  h.tile_points = r.get<std::uint32_t>();
  if (h.tile_points == 0) r.fail();
  h.ordered = r.get<std::uint8_t>() != 0;
  if (r.get<std::uint8_t>() != 0) h.grid = get_lattice(r);
  h.carry = get_carry(r);
  h.source_format = get_format(r);
  h.crs = r.text();
  const std::size_t inputs = r.count(28);
  for (std::size_t i = 0; i < inputs && r.ok(); ++i) h.inputs.push_back(get_input(r));
  h.parameters = r.text();
  return h;
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
  tile.cell = get_cell(r);
  tile.count = r.get<std::uint64_t>();
  tile.box = get_box(r);
  tile.blocks = r.get<std::uint32_t>();
  tile.segment = r.get<std::uint32_t>();
  tile.offset = r.get<std::uint64_t>();
  tile.size = r.get<std::uint64_t>();
  tile.index_size = r.get<std::uint32_t>();
  tile.index_hash = r.get<std::uint64_t>();
  tile.note = get_bytes(r);
  return tile;
}

/// Whether the tile lies right after `previous` (null: it is the first) in the segments.
bool follows(const TileInfo& tile, const TileInfo* previous) {
  if (!previous) return tile.segment == 0 && tile.offset == 0;
  if (tile.segment == previous->segment) return tile.offset == previous->offset + previous->size;
  return tile.segment == previous->segment + 1 && tile.offset == 0;
}

bool plausible(const TileInfo& tile, const StoreHeader& header) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
  return tile.count > 0 && tile.count <= header.tile_points && tile.blocks > 0 &&
         tile.blocks <= tile.count &&
         tile.index_size == tile.blocks * index_entry_size(header.schema) &&
         tile.size > tile.index_size && tile.size < kMost && tile.offset < kMost;
}

Error damaged(const std::string& path, std::uint64_t offset, const std::string& what) {
  return {Fault::kBadInput, fmt::format("{}: damaged at offset {}: {}", path, offset, what)};
}

Result<void> add_header(Manifest& m, const std::string& path, const LogRecord& record) {
  ByteReader reader(record.payload);
  const auto version = reader.get<std::uint32_t>();
  if (version != kFormatVersion)
    return Error{Fault::kBadInput,
                 fmt::format("{}: store format version {} found, this program reads version {}; "
                             "make the store anew from its inputs",
                             path, version, kFormatVersion)};
  m.header = get_header(reader);
  if (!reader.finished()) return damaged(path, record.offset, "the header record makes no sense");
  m.has_header = true;
  return {};
}

Result<void> add_tile(Manifest& m, const std::string& path, const LogRecord& record) {
  ByteReader reader(record.payload);
  TileInfo tile = get_tile(reader);
  const TileInfo* previous = m.tiles.empty() ? nullptr : &m.tiles.back();
  tile.first_row = m.points();
  const bool good = reader.finished() && plausible(tile, m.header) && follows(tile, previous) &&
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
  m.summary = reader.text();
  if (!reader.finished() || tiles != m.tiles.size() || points != m.points())
    return damaged(path, record.offset,
                   fmt::format("{} tiles of {} points found, the end record says {} of {}",
                               m.tiles.size(), m.points(), tiles, points));
  m.complete = true;
  return {};
}

}  // namespace

std::vector<std::byte> encode_header(const StoreHeader& header) {
  std::vector<std::byte> out;
  ByteWriter w(out);
  w.put(kFormatVersion);
  put(w, header.lattice);
  put(w, header.schema);
  w.put(header.tile_points);
  w.put<std::uint8_t>(header.ordered);
  w.put<std::uint8_t>(header.grid.has_value());
  if (header.grid) put(w, *header.grid);
  put(w, header.carry);
  w.put(static_cast<std::uint8_t>(header.source_format));
  w.text(header.crs);
  w.put(static_cast<std::uint32_t>(header.inputs.size()));
  for (const InputRecord& input : header.inputs) put(w, input);
  w.text(header.parameters);
  return out;
}

std::vector<std::byte> encode_tile(const TileInfo& tile) {
  std::vector<std::byte> out;
  ByteWriter w(out);
  w.put(tile.cell.first.high);
  w.put(tile.cell.first.low);
  w.put(static_cast<std::uint8_t>(tile.cell.level));
  w.put(tile.count);
  put(w, tile.box);
  w.put(tile.blocks);
  w.put(tile.segment);
  w.put(tile.offset);
  w.put(tile.size);
  w.put(tile.index_size);
  w.put(tile.index_hash);
  w.bytes(tile.note);
  return out;
}

std::vector<std::byte> encode_end(std::uint64_t tiles, std::uint64_t points,
                                  const std::string& summary) {
  std::vector<std::byte> out;
  ByteWriter w(out);
  w.put(tiles);
  w.put(points);
  w.text(summary);
  return out;
}

std::size_t index_entry_size(const Schema& schema) {
  constexpr std::size_t kColumn = sizeof(std::uint32_t) + sizeof(std::uint64_t);
  return sizeof(std::uint32_t) + 6 * sizeof(std::int64_t) + (1 + schema.fields().size()) * kColumn;
}

std::uint64_t Manifest::points() const {
  return tiles.empty() ? 0 : tiles.back().first_row + tiles.back().count;
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

}  // namespace pss
