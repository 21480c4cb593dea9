#pragma once
// A file that appears under its name only when it is complete.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "io/file/content_hash.h"
#include "io/file/file.h"
#include "io/file/output_lock.h"

namespace pss {

/// A complete file, before it has its name.
struct WrittenFile {
  std::string temporary;  ///< its name until then
  FileContent content;
};

/// What happens between a file's last sync and its renaming; its failure keeps the name away.
using BeforeRename = std::function<Result<void>(const WrittenFile&)>;

/// What may be done to the name of an output, and who has locked it.
struct OutputRules {
  bool overwrite = false;            ///< whether what is there may be replaced
  const OutputLock* lock = nullptr;  ///< on the name, where the caller holds one; outlives the file
  /// Called when the file is whole, before it gets its name: a job notes what is about to appear.
  BeforeRename before_rename = {};
};

/// Refuses a name that cannot become the output's. Errors: kFailed where it is there and not to be
/// replaced, or a directory.
Result<void> check_replaceable(const std::string& path, bool overwrite);

/// Writes a file front to back through a buffer of 1 MiB, under the temporary name of its lock
/// until finish() renames it.
///
/// Unless finished, the temporary file is removed when this goes.
/// Errors: kFailed where the name exists and may not be replaced, by create() and again by
///         finish(); where another process writes it.
class OutputFile {
 public:
  static Result<OutputFile> create(const std::string& path, const OutputRules& rules);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  const std::string& path() const { return path_; }
  std::uint64_t position() const { return position_; }

  Result<void> append(std::span<const std::byte> bytes);
  Result<void> append(std::string_view text);
  /// Overwrites bytes already appended.
  Result<void> patch(std::uint64_t offset, std::span<const std::byte> bytes);
  Result<void> finish();

 private:
  OutputFile(File file, std::string path, const OutputRules& rules, std::optional<OutputLock> lock);
  Result<void> write_through(std::uint64_t offset, std::span<const std::byte> bytes);
  Result<void> flush();
  Result<void> tell_before_rename();
  std::optional<OutputLock> lock_;  ///< where no one else holds it: the last to go
  std::string path_;
  OutputRules rules_;
  File file_;
  ContentHasher hasher_;
  std::vector<std::byte> buffer_;
  std::uint64_t position_ = 0;
  bool finished_ = false;
};

}  // namespace pss
