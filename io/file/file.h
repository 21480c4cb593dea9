#pragma once
// The only door to the disk: files by positioned reads and writes, every failure with its path.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
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
  /// To read and write, a new file: nothing that is there is ever emptied. Errors speak of it as
  /// `called`, by the name that it will have.
  static Result<File> create(const std::string& path, const std::string& called);
  static Result<File> create(const std::string& path) { return create(path, path); }
  /// The same in a folder of pss's own, where a file of this name can only be left over from a
  /// process that was killed, and is removed.
  static Result<File> create_anew(const std::string& path);
  /// To read and write a file that is there. A link, also a hard one, is refused: what else leads
  /// to the file is not pss's.
  static Result<File> open_to_write(const std::string& path);

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
  File(std::int64_t descriptor, std::string path, std::string called);
  int descriptor_ = -1;
  std::string path_;
  std::string called_;
  bool lost_ = false;  ///< a sync failed
};

/// Renames, replacing what has the new name, and makes the new name durable.
Result<void> rename_file(const std::string& from, const std::string& to);
/// The same for a name that is free. Errors: kFailed where it is not, also if it was a moment ago.
Result<void> rename_to_free_name(const std::string& from, const std::string& to);
/// Swaps two names at once, durably; false where the file system cannot do that.
Result<bool> exchange_names(const std::string& a, const std::string& b);
/// Makes the names in a directory durable.
Result<void> sync_directory(const std::string& path);
/// Makes a directory and those above it, and their names durable.
Result<void> make_directories(const std::string& path);
/// The names in a directory, sorted.
Result<std::vector<std::string>> list_directory(const std::string& path);
/// Makes a directory of pss's own, durably, or finds that it is there. Errors: kFailed for a link.
Result<void> make_own_directory(const std::string& path);
/// Removes a file's name; a missing one is no error.
Result<void> remove_file(const std::string& path);
/// Removes a directory of pss's own with the files that `is_ours` knows by their names; a missing
/// one is no error.
///
/// Errors: kFailed, with nothing removed, where it holds anything else, or is a link.
Result<void> remove_own_directory(const std::string& path,
                                  const std::function<bool(const std::string& name)>& is_ours);
/// Whether a path is there. Where that cannot be told it counts as there: opening it says why not.
bool exists(const std::string& path);
bool is_directory(const std::string& path);
bool is_link(const std::string& path);
/// The path without links and dots, as far as it exists.
std::string real_path_of(const std::string& path);
/// Whether two paths lead to one file.
bool same_file(const std::string& a, const std::string& b);
/// Whether a path leads to a place in a folder, or to the folder itself, links followed.
bool lies_in(const std::string& path, const std::string& folder);
Result<std::uint64_t> free_space(const std::string& path);
/// Whether two paths, or what of them exists, lie on one file system.
bool same_disk(const std::string& a, const std::string& b);

/// The directory part of a path, "." where there is none.
std::string directory_of(const std::string& path);

/// "csv" of "dir/name.CSV": what follows the last dot, in lower case; empty for a hidden file's
/// name.
std::string extension_of(const std::string& path);

/// Whether a name is `prefix` and a number of six digits or more.
bool is_numbered(std::string_view name, std::string_view prefix);

/// Whether a path names a store of tiles, there or not: it ends in ".pss", or ".pss/".
bool is_store_name(std::string_view path);

/// Reads a whole small file; one larger than `limit` is an error.
Result<std::vector<std::byte>> read_whole(const std::string& path, std::uint64_t limit);
/// Writes a whole small file in a folder of pss's own: a new one beside it, synced, then renamed
/// over it.
Result<void> replace_file(const std::string& path, std::span<const std::byte> bytes);
/// The same of bytes that lie in several places, and with another name for the new one until then.
Result<void> replace_file(const std::string& path,
                          std::initializer_list<std::span<const std::byte>> pieces,
                          const std::string& temporary);
/// The name of that new one until then.
std::string replacement_of(const std::string& path);

}  // namespace pss
