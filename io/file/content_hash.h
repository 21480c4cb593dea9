#pragma once
// Knows a whole file again by its content: size and a hash of every byte.

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/file/file.h"
#include "io/file/hash.h"

namespace pss {

struct FileContent {
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;  ///< since 1970; for people, a copy has another
  Hash128 hash;                  ///< of the hashes of the file's pieces of 4 MiB
};

/// Whether the bytes are the same; the time may differ, as it does for a copy.
inline bool same_bytes(const FileContent& a, const FileContent& b) {
  return a.size == b.size && a.hash == b.hash;
}

/// Hashes a file while it is written front to back. Pieces that are changed later are read again.
class ContentHasher {
 public:
  void append(std::span<const std::byte> bytes);
  std::uint64_t size() const { return size_; }
  /// Tells that bytes that were appended have changed.
  void patched(std::uint64_t offset, std::uint64_t size);
  /// Requires: `file` holds what was appended and patched.
  Result<FileContent> finish(const File& file);

 private:
  Result<void> hash_again(const File& file, std::size_t piece);
  std::vector<Hash128> pieces_;  ///< but the last, where it is not full
  StreamHash last_;
  std::uint64_t size_ = 0;
  std::set<std::size_t> changed_;
};

/// Reads a whole file. Errors: I/O; kInterrupted.
Result<FileContent> content_of(const std::string& path, Monitor& monitor);

}  // namespace pss
