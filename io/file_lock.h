#pragma once
// A lock between processes: a file that one of them holds, with its pid and host inside.

#include <optional>
#include <string>

#include "core/result.h"

namespace pss {

/// Held as long as this lives. The lock is the kernel's: it goes with its process, however that
/// ends, so a dead holder needs no clearing up.
class FileLock {
 public:
  /// Errors: kFailed where another process holds it, naming that process, or for I/O.
  static Result<FileLock> take(const std::string& path);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

/// Who holds the lock now: "process 123 on host".
std::optional<std::string> lock_holder(const std::string& path);

}  // namespace pss
