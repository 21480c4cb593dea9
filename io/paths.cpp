// The functions of io/file.h that take paths.

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "io/disk.h"
#include "io/file.h"

namespace pss {
namespace {

Error failure(std::string_view what, const std::string& path, disk::Outcome outcome) {
  const std::error_code code(static_cast<int>(-outcome), std::generic_category());
  return {Fault::kFailed, fmt::format("{}: cannot {}: {}", path, what, code.message())};
}

/// The longest part of a path that exists.
std::string existing_part(const std::string& path) {
  std::string place = path;
  while (!exists(place) && place != directory_of(place)) place = directory_of(place);
  return place;
}

}  // namespace

Result<void> rename_file(const std::string& from, const std::string& to) {
  if (const auto outcome = disk::rename(from, to); outcome < 0)
    return failure(fmt::format("rename to {}", to), from, outcome);
  return sync_directory(directory_of(to));
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

Result<void> remove_all(const std::string& path) {
  disk::Status status;
  disk::Outcome outcome = disk::status(path, disk::Links::kKeep, status);
  if (outcome == 0 && status.kind == disk::Kind::kDirectory) {
    PSS_ASSIGN(const std::vector<std::string> names, list_directory(path));
    for (const std::string& name : names) PSS_TRY(remove_all(fmt::format("{}/{}", path, name)));
    outcome = disk::remove_directory(path);
  } else if (outcome == 0) {
    outcome = disk::remove_file(path);
  }
  if (outcome < 0 && outcome != -ENOENT && outcome != -ENOTDIR)
    return failure("remove", path, outcome);
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

bool is_store_name(std::string_view path) {
  while (path.ends_with('/')) path.remove_suffix(1);
  return path.ends_with(".pss");
}

}  // namespace pss
