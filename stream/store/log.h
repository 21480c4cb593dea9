#pragma once
// An append-only file of checksummed records, whose torn tail is normal and whose damage is found.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/file/file.h"
#include "stream/store/first_failure.h"

namespace pss {

/// The file: 16 bytes of name and version, then records of a 32-byte head and a payload.
///
///   head:  u32 payload size, u32 type, u64 durable, u64 payload hash,
///          u64 hash of these 24 bytes, seeded with the record's offset in the file
///
/// `durable` is how much of the file was known to be on the disk when the record was written. So a
/// bad record is a torn tail unless a later record proves that it once was whole.
struct LogRecord {
  std::uint32_t type = 0;
  std::uint64_t offset = 0;  ///< of its head in the file
  std::span<const std::byte> payload;
};

/// Sees every record in order; its error ends the reading.
using LogVisitor = std::function<Result<void>(const LogRecord&)>;

enum class Tail {
  kMayBeTorn,  ///< whoever wrote it may have been killed: what follows the last record is ignored
  kWhole,      ///< it was finished: anything but records is damage
};

/// Reads a log; gives the bytes that its whole records take.
///
/// Errors: kBadInput with file and offset where it is damaged or no log, and what `visit` returns.
Result<std::uint64_t> read_log(const std::string& path, Tail tail, const LogVisitor& visit);

/// Bytes of a log's first record, before it is read; 0 where it has none that is whole.
Result<std::uint64_t> first_record_size(const std::string& path);

/// A record whose payload stays in the file.
struct LogPlace {
  std::uint32_t type = 0;
  std::uint64_t offset = 0;   ///< of its head
  std::uint64_t payload = 0;  ///< where that begins
  std::uint32_t size = 0;     ///< of the payload
  std::uint64_t hash = 0;

  std::uint64_t end() const { return payload + size; }
};

/// A finished log, read record by record in any order, a payload only where it is wanted.
///
/// Thread: any number at once.
/// Errors: kBadInput, with file and offset, where anything but records is found.
class LogFile {
 public:
  static constexpr std::uint64_t kFirst = 16;  ///< the offset of the first record

  static Result<LogFile> open(const std::string& path);

  const std::string& path() const { return file_.path(); }
  std::uint64_t size() const { return size_; }

  /// The record with its head at an offset below size().
  Result<LogPlace> at(std::uint64_t offset) const;
  Result<std::vector<std::byte>> payload(const LogPlace& place) const;
  /// Reads the payload against its checksum, some of it at a time.
  Result<void> check(const LogPlace& place) const;

 private:
  LogFile(File file, std::uint64_t size) : file_(std::move(file)), size_(size) {}
  Result<void> mismatch(const LogPlace& place) const;
  File file_;
  std::uint64_t size_;
};

/// Appends records. A failed append or sync is final: later ones give the same error and do
/// nothing.
class LogWriter {
 public:
  /// Makes a log with a first record, both durable before it has its name.
  static Result<LogWriter> create(const std::string& path, std::uint32_t type,
                                  std::span<const std::byte> payload);
  /// Reads what is there, cuts a torn tail, makes the rest durable.
  static Result<LogWriter> open(const std::string& path, const LogVisitor& visit);

  /// Becomes durable at the next sync.
  Result<void> append(std::uint32_t type, std::span<const std::byte> payload);
  Result<void> sync();

  std::uint64_t size() const { return size_; }

 private:
  LogWriter(File file, std::uint64_t size) : file_(std::move(file)), size_(size), durable_(size) {}
  File file_;
  FirstFailure failure_;
  std::uint64_t size_ = 0;
  std::uint64_t durable_ = 0;
};

}  // namespace pss
