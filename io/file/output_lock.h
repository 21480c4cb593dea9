#pragma once
// A lock between processes on a name that is to be written, and the temporary name that goes with
// it.

#include <optional>
#include <string>

#include "core/result.h"

namespace pss {

/// While it lives no other process of pss writes `path()`, and `temporary()` is this process's.
///
/// The lock is the kernel's, on an empty file ".NAME.pss-lock" beside NAME, so it goes with its
/// process, however that ends. Nothing is ever written into that file, and it is removed at the end
/// of the lock. A process that is killed leaves it, and what it wrote so far under the temporary
/// name, which has the lock file's inode number in it: whoever takes the lock next, and finds the
/// lock file of that very number, knows that the temporary is left over, and removes it.
class OutputLock {
 public:
  /// Errors: kFailed where another process holds the lock, naming it; where `path` or its folder
  ///         cannot be written; where something that is not pss's has the lock file's name.
  static Result<OutputLock> take(const std::string& path);

  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  ~OutputLock();

  const std::string& path() const { return path_; }
  /// In the same folder, of at most 255 bytes: a file or a directory that becomes `path()`.
  const std::string& temporary() const { return temporary_; }

 private:
  OutputLock(int descriptor, std::string path);
  Result<bool> hold(bool made);
  std::string path_;
  std::string temporary_;  ///< empty: the lock is not held yet
  int descriptor_ = -1;
};

/// The name of the file that locks `path`.
std::string lock_name_of(const std::string& path);
/// Who holds the lock on `path` now: "process 123 on host".
std::optional<std::string> lock_holder(const std::string& path);

}  // namespace pss
