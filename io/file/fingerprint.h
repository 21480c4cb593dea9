#pragma once
// Tells whether a file is still the one that was read: size, time, and a hash of both ends.

#include <cstdint>
#include <span>
#include <string>

#include "core/result.h"

namespace pss {

/// A file that points came from, as far as it tells whether it is still the same.
struct InputRecord {
  std::string path;
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;
  std::uint64_t content_hash = 0;  ///< of its first and last 64 KiB

  bool operator==(const InputRecord&) const = default;
};

/// The record of a file as it is now. `path` is kept as given.
Result<InputRecord> fingerprint(const std::string& path);

/// The record of a file that is about to be read, such that every later change shows in it.
///
/// The time of a file's last change moves in steps, of the kernel's clock or, on some file systems,
/// of whole seconds: a second change within one step leaves it as it is. So where the last change
/// is as young as a step, this waits until the step has passed, at most two seconds.
/// Errors: kFailed where the file changes meanwhile.
Result<InputRecord> settled_fingerprint(const std::string& path);

/// Refuses a file that is no longer as it was when its record was taken, before it was read.
///
/// Errors: kFailed where its size, time or ends are others, or where it cannot be read any more:
///         the file, what was found and expected, and what to do.
Result<void> check_unchanged(const InputRecord& expected);
/// The same of many; the first one that changed is named.
Result<void> check_unchanged(std::span<const InputRecord> expected);

/// What an error of reading a file means: that the file changed meanwhile, where it did. What is
/// read of a file while somebody writes it looks like damage.
Error change_or(Error error, const InputRecord& expected);

}  // namespace pss
