#include "stream/sort/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "io/file/hash.h"
#include "stream/store/bytes.h"

namespace pss {
namespace {

constexpr std::size_t kIndexEntry = 2 * sizeof(std::uint64_t) + sizeof(std::uint64_t);

/// A block's head: count, size and hash of each column, hash of the head, seeded with its offset.
std::size_t head_size(const Schema& schema) {
  return 4 + (1 + schema.fields().size()) * (4 + 8) + 8;
}

std::vector<std::byte> encode_head(const EncodedBlock& block, std::uint64_t offset) {
  std::vector<std::byte> head;
  ByteWriter writer(head);
  writer.put(block.count);
  for (const ColumnInfo& column : block.columns) {
    writer.put(column.size);
    writer.put(column.hash);
  }
  writer.put(hash64(head, offset));
  return head;
}

/// The columns of a head's block, which begin at `offset`; empty where the head is damaged.
std::vector<ColumnInfo> parse_head(std::span<const std::byte> head, std::uint64_t head_offset,
                                   const Schema& schema, std::size_t& count) {
  ByteReader reader(head);
  std::uint64_t offset = head_offset + head.size();
  count = reader.get<std::uint32_t>();
  std::vector<ColumnInfo> columns(1 + schema.fields().size());
  bool good = count > 0 && count <= kRunBlockPoints;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c].offset = offset;
    columns[c].size = reader.get<std::uint32_t>();
    columns[c].hash = reader.get<std::uint64_t>();
    offset += columns[c].size;
    good = good && columns[c].size <= column_limit(schema, c, count);
  }
  good = good && reader.get<std::uint64_t>() == hash64(head.first(head.size() - 8), head_offset);
  return good ? columns : std::vector<ColumnInfo>();
}

Key get_key(ByteReader& reader) {
  Key key;
  key.high = reader.get<std::uint64_t>();
  key.low = reader.get<std::uint64_t>();
  return key;
}

}  // namespace

std::string run_path(const std::string& folder, std::uint64_t id) {
  return fmt::format("{}/run-{:06}", folder, id);
}

bool is_run_name(std::string_view name) { return is_numbered(name, "run-"); }

RunWriter::RunWriter(File file, std::string folder, std::uint64_t id, std::uint64_t early_sync)
    : file_(std::move(file)), folder_(std::move(folder)), early_sync_(early_sync) {
  info_.id = id;
}

Result<RunWriter> RunWriter::create(const std::string& folder, std::uint64_t id,
                                    std::uint64_t early_sync) {
  PSS_ASSIGN(File file, File::create_anew(run_path(folder, id)));
  return RunWriter(std::move(file), folder, id, early_sync);
}

Result<void> RunWriter::write(std::span<const std::byte> bytes) {
  PSS_TRY(file_.write(size_, bytes));
  size_ += bytes.size();
  early_sync_.grown(file_.path(), size_);
  return {};
}

Result<void> RunWriter::append(const Key& first, const EncodedBlock& block) {
  ByteWriter index(index_);
  index.put(first.high);
  index.put(first.low);
  index.put(size_);
  PSS_TRY(write(encode_head(block, size_)));
  PSS_TRY(write(block.bytes));
  info_.points += block.count;
  ++info_.blocks;
  return {};
}

Result<RunInfo> RunWriter::finish() {
  info_.data_size = size_;
  ByteWriter(index_).put(hash64(index_, size_));
  PSS_TRY(write(index_));
  return info_;
}

Result<void> RunWriter::sync() {
  PSS_TRY(file_.sync());
  return sync_directory(folder_);
}

RunReader::RunReader(File file, const RunInfo& info, const Schema& schema)
    : file_(std::move(file)), info_(info), schema_(&schema) {}

Result<RunReader> RunReader::open(const std::string& folder, const RunInfo& info,
                                  const Schema& schema) {
  PSS_ASSIGN(File file, File::open(run_path(folder, info.id)));
  PSS_ASSIGN(const std::uint64_t size, file.size());
  const std::uint64_t expected = info.data_size + info.blocks * kIndexEntry + 8;
  if (size != expected)
    return Error{Fault::kBadInput, fmt::format("{}: {} bytes found, {} expected; use --restart",
                                               file.path(), size, expected)};
  return RunReader(std::move(file), info, schema);
}

Error RunReader::damaged(std::uint64_t offset) const {
  return {Fault::kBadInput,
          fmt::format("{}: damaged at offset {}: the bytes do not match their checksum; use "
                      "--restart",
                      file_.path(), offset)};
}

Result<void> RunReader::seek(const Key& key) {
  // The index is bounded by the file's own size, which open() has checked.
  std::vector<std::byte> bytes(info_.blocks * kIndexEntry + 8);
  PSS_TRY(file_.read(info_.data_size, bytes));
  const auto entries = std::span(bytes).first(bytes.size() - 8);
  ByteReader last{std::span(bytes).last(8)};
  if (last.get<std::uint64_t>() != hash64(entries, info_.data_size))
    return damaged(info_.data_size);
  ByteReader reader(entries);
  offset_ = 0;
  for (std::uint64_t b = 0; b < info_.blocks; ++b) {
    const Key first = get_key(reader);
    const auto offset = reader.get<std::uint64_t>();
    // Points with this very key may begin in the block before.
    if (first >= key) break;
    offset_ = offset;
  }
  return {};
}

Result<void> RunReader::next(RunBlock& out) {
  out.count = 0;
  if (ended()) return {};
  std::vector<std::byte> head(head_size(*schema_));
  PSS_TRY(file_.read(offset_, head));
  std::size_t count = 0;
  out.columns = parse_head(head, offset_, *schema_, count);
  if (out.columns.empty()) return damaged(offset_);
  const std::uint64_t start = out.columns.front().offset;
  offset_ = out.columns.back().offset + out.columns.back().size;
  out.bytes.resize(offset_ - start);
  PSS_TRY(file_.read(start, out.bytes));
  out.count = count;
  return {};
}

Result<void> RunReader::decode(const RunBlock& block, std::span<Key> keys,
                               std::span<std::byte> rows) const {
  const std::uint64_t start = block.columns.front().offset;
  const auto& fields = schema_->fields();
  const auto space = std::make_unique_for_overwrite<Index3[]>(block.count);
  const std::span<Index3> positions(space.get(), block.count);
  for (std::size_t c = 0; c < block.columns.size(); ++c) {
    const ColumnInfo& info = block.columns[c];
    const auto column = std::span(block.bytes).subspan(info.offset - start, info.size);
    if (hash64(column) != info.hash ||
        !(c == 0 ? decode_positions(column, positions)
                 : decode_field(fields[c - 1], column, block.count,
                                rows.data() + schema_->position(c - 1), schema_->row_size())))
      return damaged(info.offset);
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!on_lattice(positions[i])) return damaged(start);
    keys[i] = encode_key(positions[i]);
  }
  return {};
}

}  // namespace pss
