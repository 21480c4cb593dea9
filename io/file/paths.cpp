// The functions of io/file/file.h that take paths.

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>

#include "io/file/disk.h"
#include "io/file/disk_failure.h"
#include "io/file/file.h"

namespace pss {
namespace {

using disk::failure;

bool unknown_call(disk::Outcome outcome) {
  return outcome == -EINVAL || outcome == -ENOSYS || outcome == -EOPNOTSUPP;
}

/// The longest part of a path that exists.
std::string existing_part(const std::string& path) {
  std::string place = path;
  while (!exists(place) && place != directory_of(place)) place = directory_of(place);
  return place;
}

/// A link could lead to anybody's directory.
Result<void> check_own_directory(const std::string& path) {
  disk::Status status;
  const disk::Outcome outcome = disk::status(path, disk::Links::kKeep, status);
  if (outcome < 0) return failure("find", path, outcome);
  if (status.kind == disk::Kind::kDirectory) return {};
  return Error{Fault::kFailed, fmt::format("{}: found a link or a file, expected a directory of "
                                           "pss's own; move it elsewhere",
                                           path)};
}

}  // namespace

Result<void> rename_file(const std::string& from, const std::string& to) {
  if (const auto outcome = disk::rename(from, to); outcome < 0)
    return failure(fmt::format("rename to {}", to), from, outcome);
  return sync_directory(directory_of(to));
}

Result<void> rename_to_free_name(const std::string& from, const std::string& to) {
  const disk::Outcome outcome = disk::rename_to_free(from, to);
  if (outcome == 0) return sync_directory(directory_of(to));
  if (outcome != -EEXIST && !unknown_call(outcome))
    return failure(fmt::format("rename to {}", to), from, outcome);
  // Not every file system knows the call.
  if (outcome == -EEXIST || exists(to))
    return Error{Fault::kFailed, fmt::format("{}: exists; use --overwrite to replace it", to)};
  return rename_file(from, to);
}

Result<bool> exchange_names(const std::string& a, const std::string& b) {
  const disk::Outcome outcome = disk::exchange(a, b);
  if (unknown_call(outcome)) return false;
  if (outcome < 0) return failure(fmt::format("exchange with {}", b), a, outcome);
  PSS_TRY(sync_directory(directory_of(a)));
  PSS_TRY(sync_directory(directory_of(b)));
  return true;
}

Result<void> sync_directory(const std::string& path) {
  const disk::Outcome outcome = disk::sync_directory(path);
  // Some file systems cannot sync a directory and say so; there is nothing more to be done.
  if (outcome < 0 && outcome != -EINVAL) return failure("sync the directory", path, outcome);
  return {};
}

Result<void> make_directories(const std::string& path) {
  if (is_directory(path)) return {};
  const std::string parent = directory_of(path);
  if (parent != path) PSS_TRY(make_directories(parent));
  const disk::Outcome outcome = disk::make_directory(path);
  if (outcome == -EEXIST && is_directory(path)) return {};
  if (outcome < 0) return failure("make the directory", path, outcome);
  return sync_directory(parent);
}

Result<std::vector<std::string>> list_directory(const std::string& path) {
  std::vector<std::string> names;
  if (const auto outcome = disk::list(path, names); outcome < 0)
    return failure("read the directory", path, outcome);
  std::ranges::sort(names);
  return names;
}

Result<void> make_own_directory(const std::string& path) {
  const disk::Outcome outcome = disk::make_directory(path);
  if (outcome == 0) return sync_directory(directory_of(path));
  if (outcome != -EEXIST) return failure("make the directory", path, outcome);
  return check_own_directory(path);
}

Result<void> remove_file(const std::string& path) {
  const disk::Outcome outcome = disk::remove_file(path);
  if (outcome < 0 && outcome != -ENOENT && outcome != -ENOTDIR)
    return failure("remove", path, outcome);
  return {};
}

Result<void> remove_own_directory(const std::string& path,
                                  const std::function<bool(const std::string& name)>& is_ours) {
  if (!exists(path)) return {};
  PSS_TRY(check_own_directory(path));
  PSS_ASSIGN(const std::vector<std::string> names, list_directory(path));
  for (const std::string& name : names)
    if (!is_ours(name))
      return Error{Fault::kFailed, fmt::format("{}: found {}, which pss did not make, so that the "
                                               "directory is not removed; move it elsewhere",
                                               path, name)};
  // In reverse, so that what tells whose directory this is goes last: a manifest, a log.
  for (auto name = names.rbegin(); name != names.rend(); ++name)
    PSS_TRY(remove_file(fmt::format("{}/{}", path, *name)));
  const disk::Outcome outcome = disk::remove_directory(path);
  if (outcome < 0 && outcome != -ENOENT) return failure("remove", path, outcome);
  return {};
}

bool exists(const std::string& path) {
  disk::Status status;  // a link that leads nowhere is there, too
  const disk::Outcome outcome = disk::status(path, disk::Links::kKeep, status);
  return outcome != -ENOENT && outcome != -ENOTDIR;
}

bool is_directory(const std::string& path) {
  disk::Status status;
  return disk::status(path, disk::Links::kFollow, status) == 0 &&
         status.kind == disk::Kind::kDirectory;
}

std::string real_path_of(const std::string& path) { return disk::canonical(path); }

bool is_link(const std::string& path) {
  disk::Status status;
  return disk::status(path, disk::Links::kKeep, status) == 0 && status.kind == disk::Kind::kLink;
}

bool same_file(const std::string& a, const std::string& b) {
  disk::Status first, second;
  return disk::status(a, disk::Links::kFollow, first) == 0 &&
         disk::status(b, disk::Links::kFollow, second) == 0 && first.device == second.device &&
         first.inode == second.inode;
}

bool same_disk(const std::string& a, const std::string& b) {
  disk::Status first, second;
  return disk::status(existing_part(a), disk::Links::kFollow, first) == 0 &&
         disk::status(existing_part(b), disk::Links::kFollow, second) == 0 &&
         first.device == second.device;
}

bool lies_in(const std::string& path, const std::string& folder) {
  const std::string whole = disk::canonical(path);
  const std::string outer = disk::canonical(folder);
  return whole.starts_with(outer) &&
         (whole.size() == outer.size() || outer.ends_with('/') || whole[outer.size()] == '/');
}

Result<std::uint64_t> free_space(const std::string& path) {
  const std::string place = existing_part(path);
  std::uint64_t bytes = 0;
  if (const auto outcome = disk::free_space(place, bytes); outcome < 0)
    return failure("find the free space", place, outcome);
  return bytes;
}

std::string directory_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  if (slash == std::string::npos) return ".";
  const std::size_t end = path.find_last_not_of('/', slash);
  return end == std::string::npos ? "/" : path.substr(0, end + 1);
}

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return "";
  if (dot == 0 || path[dot - 1] == '/') return "";  // the name of a hidden file
  std::string extension = path.substr(dot + 1);
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

bool is_numbered(std::string_view name, std::string_view prefix) {
  constexpr std::size_t kFewestDigits = 6;
  return name.starts_with(prefix) && name.size() >= prefix.size() + kFewestDigits &&
         name.find_first_not_of("0123456789", prefix.size()) == std::string_view::npos;
}

bool is_store_name(std::string_view path) {
  while (path.ends_with('/')) path.remove_suffix(1);
  return path.ends_with(".pss");
}

}  // namespace pss
