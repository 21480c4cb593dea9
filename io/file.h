#pragma once
// The only door to the disk: files by positioned reads and writes, every failure with its path.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace pss {

struct FileState {
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;  ///< since 1970
};

/// An open file. Moved, never copied; closed at the end of its life.
class File {
 public:
  /// To read. What is no regular file (a directory, a pipe) is refused.
  static Result<File> open(const std::string& path);
  static Result<File> create(const std::string& path);          ///< to read and write, emptied
  static Result<File> open_or_create(const std::string& path);  ///< to read and write, as it is
  static Result<File> open_to_write(const std::string& path);   ///< to read and write; it is there

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  const std::string& path() const { return path_; }

  Result<FileState> state() const;
  Result<std::uint64_t> size() const;

  /// Fills `out` from `offset`; the number of bytes is smaller only at the end of the file.
  Result<std::size_t> read_some(std::uint64_t offset, std::span<std::byte> out) const;

  /// Fills `out` whole. Errors: kBadInput with offset, found and expected where the file is short.
  Result<void> read(std::uint64_t offset, std::span<std::byte> out) const;

  Result<void> write(std::uint64_t offset, std::span<const std::byte> bytes);
  Result<void> truncate(std::uint64_t size);
  /// Makes content, size and time durable. A failure is final: what was written may be lost, and is
  /// never tried again.
  Result<void> sync();

 private:
  File(std::int64_t descriptor, std::string path);
  int descriptor_ = -1;
  std::string path_;
  bool lost_ = false;  ///< a sync failed
};

/// Renames and makes the new name durable.
Result<void> rename_file(const std::string& from, const std::string& to);
/// Makes the names in a directory durable.
Result<void> sync_directory(const std::string& path);
/// Makes a directory and those above it, and their names durable.
Result<void> make_directories(const std::string& path);
/// The names in a directory, sorted.
Result<std::vector<std::string>> list_directory(const std::string& path);
/// Removes a file or a whole directory; a missing one is no error.
Result<void> remove_all(const std::string& path);
/// Whether a path is there. Where that cannot be told it counts as there: opening it says why not.
bool exists(const std::string& path);
bool is_directory(const std::string& path);
/// Whether two paths lead to one file.
bool same_file(const std::string& a, const std::string& b);
/// Whether a path leads to a place in a folder, or to the folder itself, links followed.
bool lies_in(const std::string& path, const std::string& folder);
Result<std::uint64_t> free_space(const std::string& path);
/// Whether two paths, or what of them exists, lie on one file system.
bool same_disk(const std::string& a, const std::string& b);

/// The directory part of a path, "." where there is none.
std::string directory_of(const std::string& path);

/// Whether a path names a store of tiles, there or not: it ends in ".pss", or ".pss/".
bool is_store_name(std::string_view path);

/// Reads a whole small file; one larger than `limit` is an error.
Result<std::vector<std::byte>> read_whole(const std::string& path, std::uint64_t limit);
/// Writes a whole small file: a new one beside it, synced, then renamed over it.
Result<void> replace_file(const std::string& path, std::span<const std::byte> bytes);

/// What happens between a file's last sync and its renaming; its failure keeps the name away.
using BeforeRename = std::function<Result<void>(const std::string& part)>;

/// Writes a file front to back through a buffer of 1 MiB, as NAME.part until finish() renames it.
///
/// Unless finished, NAME.part is removed when this goes.
/// Errors: kFailed where NAME exists and `overwrite` is false, by create() and again by finish().
class OutputFile {
 public:
  /// `before_rename` is called with the name of the complete, synced file just before it gets
  /// its own: a job can note what is about to appear there.
  static Result<OutputFile> create(const std::string& path, bool overwrite,
                                   BeforeRename before_rename = {});
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
  OutputFile(File file, std::string path, bool overwrite, BeforeRename before_rename);
  Result<void> flush();
  std::string path_;
  bool overwrite_ = false;
  BeforeRename before_rename_;
  File file_;
  std::vector<std::byte> buffer_;
  std::uint64_t position_ = 0;
  bool finished_ = false;
};

}  // namespace pss
