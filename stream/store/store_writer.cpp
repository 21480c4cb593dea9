#include "stream/store/store_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "io/file/hash.h"
#include "stream/store/bytes.h"
#include "stream/store/store.h"

namespace pss {
namespace {

IndexBox box_of_blocks(std::span<const BlockInfo> blocks) {
  IndexBox box;
  for (const BlockInfo& block : blocks) box.add(block.box);
  return box;
}

std::uint64_t count_rows(std::span<const BlockInfo> blocks) {
  std::uint64_t rows = 0;
  for (const BlockInfo& block : blocks) rows += block.count;
  return rows;
}

/// What tiles are checked by. The carried bytes are in the log and not held a second time.
StoreHeader needed_of(const StoreHeader& header) {
  StoreHeader needed;
  needed.lattice = header.lattice;
  needed.schema = header.schema;
  needed.tile_points = header.tile_points;
  needed.ordered = header.ordered;
  needed.inputs = header.inputs;
  return needed;
}

Error other_inputs(const std::string& path) {
  return {
      Fault::kFailed,
      fmt::format("{}: was made from other inputs or parameters; use --restart where it is of a "
                  "job, or choose another name",
                  path)};
}

/// Another version of pss may compute other bytes: two do not make one store.
Error other_producer(const std::string& path, const std::string& found) {
  return {Fault::kFailed,
          fmt::format("{}: was begun by {}, and this is {}; finish it with that one, use --restart "
                      "where it is of a job, or choose another name",
                      path, found, producer())};
}

}  // namespace

Result<StoreWriter> StoreWriter::create(const std::string& path, const StoreHeader& header,
                                        std::uint64_t segment_size) {
  PSS_TRY(remove_store(path));
  PSS_TRY(make_directories(directory_of(path)));
  PSS_TRY(make_own_directory(path));
  StoreWriter writer;
  writer.path_ = path;
  writer.segment_limit_ = segment_size;
  writer.manifest_.header = needed_of(header);
  writer.manifest_.producer = producer();
  writer.manifest_.has_header = true;
  PSS_ASSIGN(LogWriter log, LogWriter::create(open_manifest_path(path),
                                              static_cast<std::uint32_t>(RecordType::kHeader),
                                              encode_header(header)));
  writer.log_ = std::move(log);
  PSS_TRY(sync_directory(directory_of(path)));
  return writer;
}

Result<StoreWriter> StoreWriter::resume(const std::string& path, const StoreHeader& header,
                                        std::uint64_t segment_size) {
  StoreWriter writer;
  writer.path_ = path;
  writer.segment_limit_ = segment_size;
  const bool finished = exists(manifest_path(path));
  PSS_TRY(writer.open_manifest(finished ? manifest_path(path) : open_manifest_path(path), header));
  if (!writer.manifest_.has_header) return other_inputs(path);
  if (finished) return writer;
  PSS_TRY(writer.cut_segments());
  // Killed between the end record and the rename.
  if (writer.complete()) PSS_TRY(writer.rename_manifest());
  return writer;
}

Result<void> StoreWriter::add_record(const std::string& name, const LogRecord& record,
                                     const StoreHeader& header) {
  const bool first = static_cast<RecordType>(record.type) == RecordType::kHeader;
  if (!first || manifest_.has_header) return manifest_.add(name, record);
  return take_header(name, record.payload, header);
}

/// Takes the header where it is the expected one: compared, and not read into another.
Result<void> StoreWriter::take_header(const std::string& name, std::span<const std::byte> payload,
                                      const StoreHeader& header) {
  PSS_TRY(check_version(name, payload));
  manifest_.producer = producer_in(payload);
  const bool finished = name == manifest_path(path_);
  if (!finished && manifest_.producer != producer())
    return other_producer(path_, manifest_.producer);
  if (!is_encoded(header, payload, manifest_.producer)) return other_inputs(path_);
  manifest_.header = needed_of(header);
  manifest_.has_header = true;
  return {};
}

Result<void> StoreWriter::open_manifest(const std::string& name, const StoreHeader& header) {
  const auto visit = [&](const LogRecord& record) { return add_record(name, record, header); };
  if (name == manifest_path(path_)) {
    PSS_TRY(read_log(name, Tail::kWhole, visit));
    if (manifest_.complete) return {};
    return Error{Fault::kBadInput, fmt::format("{}: damaged: the end record is missing", name)};
  }
  PSS_ASSIGN(LogWriter log, LogWriter::open(name, visit));
  log_ = std::move(log);
  recorded_ = manifest_.tiles.size();
  return {};
}

/// Removes what no record speaks of: the end of the last segment, and segments after it.
Result<void> StoreWriter::cut_segments() {
  std::uint32_t extra = 0;
  if (manifest_.segments() > 0) {
    const TileInfo& last = manifest_.tiles.back();  // an empty one stands where points end
    PSS_ASSIGN(File file, File::open_to_write(segment_path(path_, last.segment)));
    PSS_ASSIGN(const std::uint64_t size, file.size());
    segment_number_ = last.segment;
    segment_size_ = last.offset + last.size;
    if (size < segment_size_)
      return Error{Fault::kBadInput, fmt::format("{}: damaged at offset {}: {} bytes found, {} "
                                                 "expected",
                                                 file.path(), size, size, segment_size_)};
    PSS_TRY(file.truncate(segment_size_));
    segment_ = std::move(file);
    extra = last.segment + 1;
  }
  for (; exists(segment_path(path_, extra)); ++extra)
    PSS_TRY(remove_file(segment_path(path_, extra)));
  return {};
}

Result<void> StoreWriter::next_segment() {
  // Order: the full segment is on the disk, and the new one's name, before any record speaks of it.
  if (segment_) PSS_TRY(segment_->sync());
  segment_number_ = segment_ ? segment_number_ + 1 : 0;
  segment_size_ = 0;
  PSS_ASSIGN(File file, File::create_anew(segment_path(path_, segment_number_)));
  segment_ = std::move(file);
  return sync_directory(path_);
}

Result<void> StoreWriter::append(const EncodedBlock& block) {
  return failure_.guard([&] { return write_block(block); });
}

Result<void> StoreWriter::commit_tile(const Cell& cell, std::uint64_t source, Note note,
                                      bool sync_now) {
  PSS_TRY(failure_.guard([&] { return end_tile(cell, source, std::move(note)); }));
  return sync_now ? sync() : Result<void>();
}

Result<void> StoreWriter::sync() {
  return failure_.guard([&] { return write_records(); });
}

Result<void> StoreWriter::finish(const std::string& summary, const Note& note) {
  return failure_.guard([&] { return end_store(summary, note); });
}

Result<void> StoreWriter::write_block(const EncodedBlock& block) {
  assert(!complete() && block.count > 0);
  if (!segment_ || (blocks_.empty() && segment_size_ >= segment_limit_)) PSS_TRY(next_segment());
  PSS_TRY(segment_->write(segment_size_, block.bytes));
  BlockInfo& info = blocks_.emplace_back();
  info.count = block.count;
  info.box = block.box;
  info.columns = block.columns;
  for (ColumnInfo& column : info.columns) column.offset += segment_size_;
  segment_size_ += block.bytes.size();
  return {};
}

/// Gives the bytes that were written: none for an empty tile.
Result<std::vector<std::byte>> StoreWriter::write_index() {
  std::vector<std::byte> index = encode_index(blocks_);
  if (index.empty()) return index;
  PSS_TRY(segment_->write(segment_size_, index));
  segment_size_ += index.size();
  return index;
}

Result<void> StoreWriter::end_tile(const Cell& cell, std::uint64_t source, Note note) {
  assert(source >= next_source());
  PSS_ASSIGN(const std::vector<std::byte> index, write_index());
  TileInfo tile;
  tile.source = source;
  tile.cell = cell;
  tile.first_row = manifest_.points();
  tile.count = count_rows(blocks_);
  assert(tile.count <= manifest_.header.tile_points);
  tile.box = box_of_blocks(blocks_);
  tile.blocks = static_cast<std::uint32_t>(blocks_.size());
  tile.segment = segment_number_;
  tile.offset = blocks_.empty() ? segment_size_ : blocks_[0].columns[0].offset;
  tile.size = segment_size_ - tile.offset;
  tile.index_size = static_cast<std::uint32_t>(index.size());
  tile.index_hash = hash64(index);
  tile.note = std::move(note);
  unsynced_bytes_ += tile.size;
  manifest_.tiles.push_back(std::move(tile));
  blocks_.clear();
  return {};
}

Result<void> StoreWriter::write_records() {
  if (recorded_ == manifest_.tiles.size()) return {};
  // Order: points before the records that speak of them. Otherwise a power cut could leave a
  // record whose tile is not on the disk.
  if (segment_) PSS_TRY(segment_->sync());
  for (; recorded_ < manifest_.tiles.size(); ++recorded_)
    PSS_TRY(log_->append(static_cast<std::uint32_t>(RecordType::kTile),
                         encode_tile(manifest_.tiles[recorded_])));
  unsynced_bytes_ = 0;
  return log_->sync();
}

Result<void> StoreWriter::end_store(const std::string& summary, const Note& note) {
  assert(!complete() && blocks_.empty());
  PSS_TRY(write_records());
  if (const std::uint64_t inputs = manifest_.header.inputs.count; inputs > 0) {
    PSS_ASSIGN(const InputTable table, InputTable::open(path_, inputs));
    manifest_.input_bytes = table.bytes();
  }
  manifest_.note = note;
  manifest_.summary = summary;
  PSS_TRY(log_->append(static_cast<std::uint32_t>(RecordType::kEnd), encode_end(manifest_)));
  PSS_TRY(log_->sync());
  manifest_.complete = true;
  return rename_manifest();
}

/// From here on the manifest has no torn tail: anything odd in it is damage.
Result<void> StoreWriter::rename_manifest() {
  log_.reset();
  return rename_file(open_manifest_path(path_), manifest_path(path_));
}

}  // namespace pss
