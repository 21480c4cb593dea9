#include "stream/store/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "io/file/file_window.h"
#include "io/file/hash.h"
#include "stream/store/bytes.h"

namespace pss {
namespace {

constexpr std::array<char, 16> kName = {'p', 's', 's', ' ', 'l', 'o', 'g', ' ',
                                        '1', 0,   0,   0,   0,   0,   0,   0};
constexpr std::size_t kHeadSize = 32;
constexpr std::size_t kHashedHead = 24;
constexpr std::size_t kWindow = 256 << 10;

static_assert(kName.size() == LogFile::kFirst);

struct Head {
  std::uint32_t size = 0;
  std::uint32_t type = 0;
  std::uint64_t durable = 0;
  std::uint64_t payload_hash = 0;
};

void append_head(std::vector<std::byte>& out, std::uint64_t offset, const Head& head) {
  const std::size_t start = out.size();
  ByteWriter writer(out);
  writer.put(head.size);
  writer.put(head.type);
  writer.put(head.durable);
  writer.put(head.payload_hash);
  writer.put(hash64(std::span(out).subspan(start, kHashedHead), offset));
}

/// The head at `offset` of the file, or nothing where the bytes are none.
std::optional<Head> parse_head(std::span<const std::byte> bytes, std::uint64_t offset) {
  ByteReader reader(bytes);
  Head head;
  head.size = reader.get<std::uint32_t>();
  head.type = reader.get<std::uint32_t>();
  head.durable = reader.get<std::uint64_t>();
  head.payload_hash = reader.get<std::uint64_t>();
  const auto found = reader.get<std::uint64_t>();
  if (!reader.ok() || found != hash64(bytes.first(kHashedHead), offset)) return std::nullopt;
  return head;
}

Error damaged(const std::string& path, std::uint64_t offset, const std::string& what) {
  return {Fault::kBadInput, fmt::format("{}: damaged at offset {}: {}", path, offset, what)};
}

/// Gives the record at `offset`, or nothing where the bytes there are none.
Result<std::optional<LogRecord>> record_at(FileWindow& window, std::uint64_t offset) {
  if (window.end() - offset < kHeadSize) return std::optional<LogRecord>();
  PSS_ASSIGN(const auto head_bytes, window.at(offset, kHeadSize));
  const auto head = parse_head(head_bytes, offset);
  if (!head || head->size > window.end() - offset - kHeadSize) return std::optional<LogRecord>();
  PSS_ASSIGN(const auto payload, window.at(offset + kHeadSize, head->size));
  if (hash64(payload) != head->payload_hash) return std::optional<LogRecord>();
  return std::optional(LogRecord{head->type, offset, payload});
}

/// Whether a head after `bad` says that the bytes at `bad` were once durable.
Result<bool> proves_damage(FileWindow& window, std::uint64_t bad) {
  for (std::uint64_t at = bad + 1; at + kHeadSize <= window.end(); ++at) {
    PSS_ASSIGN(const auto bytes, window.at(at, kHeadSize));
    const auto head = parse_head(bytes, at);
    if (head && head->durable > bad) return true;
  }
  return false;
}

Result<void> check_name(FileWindow& window, const std::string& path) {
  const auto expected = std::as_bytes(std::span(kName));
  if (window.end() < kName.size())
    return damaged(
        path, 0, fmt::format("{} bytes found, a log has at least {}", window.end(), kName.size()));
  PSS_ASSIGN(const auto found, window.at(0, kName.size()));
  if (!std::ranges::equal(found, expected))
    return damaged(path, 0, "it does not begin as a log of version 1 does");
  return {};
}

Result<std::uint64_t> read_records(const File& file, Tail tail, const LogVisitor& visit) {
  PSS_ASSIGN(const std::uint64_t size, file.size());
  FileWindow window(file, size, kWindow);
  PSS_TRY(check_name(window, file.path()));
  std::uint64_t offset = kName.size();
  while (offset < size) {
    PSS_ASSIGN(const auto record, record_at(window, offset));
    if (!record) break;
    const std::uint64_t next = offset + kHeadSize + record->payload.size();
    PSS_TRY(visit(*record));
    offset = next;
  }
  if (offset == size && offset > kName.size()) return offset;
  const char* what = "a record does not match its checksum";
  // The first record was durable before the file had its name.
  if (tail == Tail::kWhole || offset == kName.size()) return damaged(file.path(), offset, what);
  PSS_ASSIGN(const bool damage, proves_damage(window, offset));
  if (damage) return damaged(file.path(), offset, what);
  return offset;
}

Result<Head> make_head(const std::string& path, std::uint32_t type, std::uint64_t durable,
                       std::span<const std::byte> payload) {
  if (payload.size() > std::numeric_limits<std::uint32_t>::max())
    return Error{Fault::kFailed, fmt::format("{}: a record of {} bytes is more than a log holds",
                                             path, payload.size())};
  return Head{static_cast<std::uint32_t>(payload.size()), type, durable, hash64(payload)};
}

}  // namespace

Result<std::uint64_t> read_log(const std::string& path, Tail tail, const LogVisitor& visit) {
  PSS_ASSIGN(const File file, File::open(path));
  return read_records(file, tail, visit);
}

Result<std::uint64_t> first_record_size(const std::string& path) {
  PSS_ASSIGN(const File file, File::open(path));
  std::vector<std::byte> bytes(kName.size() + kHeadSize);
  PSS_ASSIGN(const std::size_t got, file.read_some(0, bytes));
  PSS_ASSIGN(const std::uint64_t size, file.size());
  if (got < bytes.size()) return std::uint64_t{0};
  const auto head = parse_head(std::span(bytes).subspan(kName.size()), kName.size());
  return head ? std::min<std::uint64_t>(head->size, size) : 0;
}

Result<LogFile> LogFile::open(const std::string& path) {
  PSS_ASSIGN(File file, File::open(path));
  PSS_ASSIGN(const std::uint64_t size, file.size());
  {
    FileWindow window(file, size, kName.size());
    PSS_TRY(check_name(window, path));
  }
  if (size == kFirst) return damaged(path, size, "it has no record");
  return LogFile(std::move(file), size);
}

Result<LogPlace> LogFile::at(std::uint64_t offset) const {
  std::array<std::byte, kHeadSize> bytes;
  PSS_ASSIGN(const std::size_t got, file_.read_some(offset, bytes));
  const auto head = parse_head(std::span(bytes).first(got), offset);
  if (!head || head->size > size_ - offset - kHeadSize)
    return damaged(path(), offset, "the head of a record does not match its checksum");
  return LogPlace{head->type, offset, offset + kHeadSize, head->size, head->payload_hash};
}

Result<void> LogFile::mismatch(const LogPlace& place) const {
  return damaged(path(), place.offset, "a record does not match its checksum");
}

Result<std::vector<std::byte>> LogFile::payload(const LogPlace& place) const {
  std::vector<std::byte> bytes(place.size);
  PSS_TRY(file_.read(place.payload, bytes));
  if (hash64(bytes) != place.hash) PSS_TRY(mismatch(place));
  return bytes;
}

Result<void> LogFile::check(const LogPlace& place) const {
  StreamHash hash;
  std::vector<std::byte> piece(std::min<std::size_t>(kWindow, place.size));
  for (std::uint64_t at = place.payload; at < place.end(); at += piece.size()) {
    const auto part = std::span(piece).first(
        static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), place.end() - at)));
    PSS_TRY(file_.read(at, part));
    hash.update(part);
  }
  return hash.digest64() == place.hash ? Result<void>() : mismatch(place);
}

Result<LogWriter> LogWriter::create(const std::string& path, std::uint32_t type,
                                    std::span<const std::byte> payload) {
  PSS_ASSIGN(const Head head, make_head(path, type, 0, payload));
  std::vector<std::byte> start;
  ByteWriter(start).raw(std::as_bytes(std::span(kName)));
  append_head(start, kName.size(), head);
  PSS_TRY(replace_file(path, {start, payload}, replacement_of(path)));
  PSS_ASSIGN(File file, File::open_to_write(path));
  return LogWriter(std::move(file), start.size() + payload.size());
}

Result<LogWriter> LogWriter::open(const std::string& path, const LogVisitor& visit) {
  PSS_ASSIGN(File file, File::open_to_write(path));
  PSS_ASSIGN(const std::uint64_t size, read_records(file, Tail::kMayBeTorn, visit));
  PSS_TRY(file.truncate(size));
  // What was read may be in the page cache only; from here on it counts as durable.
  PSS_TRY(file.sync());
  return LogWriter(std::move(file), size);
}

Result<void> LogWriter::append(std::uint32_t type, std::span<const std::byte> payload) {
  return failure_.guard([&]() -> Result<void> {
    PSS_ASSIGN(const Head head, make_head(file_.path(), type, durable_, payload));
    std::vector<std::byte> bytes;
    append_head(bytes, size_, head);
    const bool apart = payload.size() > kWindow;  // it is not copied
    if (!apart) ByteWriter(bytes).raw(payload);
    PSS_TRY(file_.write(size_, bytes));
    if (apart) PSS_TRY(file_.write(size_ + bytes.size(), payload));
    size_ += kHeadSize + payload.size();
    return {};
  });
}

Result<void> LogWriter::sync() {
  return failure_.guard([&]() -> Result<void> {
    PSS_TRY(file_.sync());
    durable_ = size_;
    return {};
  });
}

}  // namespace pss
