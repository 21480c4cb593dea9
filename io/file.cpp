#include "io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

namespace pss {
namespace {

constexpr std::uint64_t kLargestOffset = std::numeric_limits<off_t>::max();

Error failure(std::string_view what, const std::string& path, int code) {
  return {Fault::kFailed,
          fmt::format("{}: cannot {}: {}", path, what, std::generic_category().message(code))};
}

int open_descriptor(const std::string& path, int flags) {
  int descriptor = -1;
  do {
    descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

bool past_the_largest(std::uint64_t offset, std::size_t size) {
  return offset > kLargestOffset || size > kLargestOffset - offset;
}

}  // namespace

File::File(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      lost_(other.lost_) {}

File& File::operator=(File&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  std::swap(lost_, other.lost_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<File> File::open(const std::string& path) {
  // Without O_NONBLOCK a pipe that nobody writes would stop us here.
  const int descriptor = open_descriptor(path, O_RDONLY | O_NONBLOCK);
  if (descriptor < 0) return failure("open", path, errno);
  File file(descriptor, path);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return failure("open", path, errno);
  if (S_ISDIR(status.st_mode)) return failure("read as a file", path, EISDIR);
  if (!S_ISREG(status.st_mode))
    return Error{Fault::kFailed, fmt::format("{}: is no regular file; pss reads files by position, "
                                             "so save its content to a file first",
                                             path)};
  return file;
}

Result<File> File::create(const std::string& path) {
  const int descriptor = open_descriptor(path, O_RDWR | O_CREAT | O_TRUNC);
  if (descriptor < 0) return failure("create", path, errno);
  return File(descriptor, path);
}

Result<File> File::open_or_create(const std::string& path) {
  const int descriptor = open_descriptor(path, O_RDWR | O_CREAT);
  if (descriptor < 0) return failure("open for writing", path, errno);
  return File(descriptor, path);
}

Result<std::uint64_t> File::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) return failure("find the size", path_, errno);
  return static_cast<std::uint64_t>(status.st_size);
}

Result<std::size_t> File::read_some(std::uint64_t offset, std::span<std::byte> out) const {
  std::size_t done = 0;
  while (done < out.size() && !past_the_largest(offset + done, out.size() - done)) {
    const ssize_t got = ::pread(descriptor_, out.data() + done, out.size() - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return failure(fmt::format("read at offset {}", offset + done), path_, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

Result<void> File::read(std::uint64_t offset, std::span<std::byte> out) const {
  PSS_ASSIGN(const std::size_t found, read_some(offset, out));
  if (found == out.size()) return {};
  return Error{Fault::kBadInput,
               fmt::format("{}: the file ends too early: at offset {} found {} bytes, expected {}",
                           path_, offset, found, out.size())};
}

Result<void> File::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (lost_) return failure("write after a failed sync", path_, EIO);
  if (past_the_largest(offset, bytes.size())) return failure("write", path_, EFBIG);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put = ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done,
                                 static_cast<off_t>(offset + done));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return failure(fmt::format("write at offset {}", offset + done), path_, errno);
    if (put == 0) return failure(fmt::format("write at offset {}", offset + done), path_, ENOSPC);
    done += static_cast<std::size_t>(put);
  }
  return {};
}

Result<void> File::truncate(std::uint64_t size) {
  if (size > kLargestOffset) return failure("resize", path_, EFBIG);
  int outcome = 0;
  do {
    outcome = ::ftruncate(descriptor_, static_cast<off_t>(size));
  } while (outcome != 0 && errno == EINTR);
  if (outcome != 0) return failure("resize", path_, errno);
  return {};
}

Result<void> File::sync() {
  if (lost_) return failure("sync again after a failed sync", path_, EIO);
  if (::fdatasync(descriptor_) == 0) return {};
  // The kernel may have dropped the dirty pages: a second sync would succeed and lie.
  lost_ = true;
  return failure("sync", path_, errno);
}

Result<void> rename_file(const std::string& from, const std::string& to) {
  if (::rename(from.c_str(), to.c_str()) != 0)
    return failure(fmt::format("rename to {}", to), from, errno);
  return sync_directory(directory_of(to));
}

Result<void> sync_directory(const std::string& path) {
  const int descriptor = open_descriptor(path, O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return failure("open the directory", path, errno);
  const int outcome = ::fsync(descriptor);
  const int code = errno;
  ::close(descriptor);
  // Some file systems cannot sync a directory and say so; there is nothing more to be done.
  if (outcome != 0 && code != EINVAL) return failure("sync the directory", path, code);
  return {};
}

Result<void> make_directories(const std::string& path) {
  std::error_code code;
  std::filesystem::create_directories(path, code);
  if (code) return failure("make the directory", path, code.value());
  return {};
}

Result<void> remove_all(const std::string& path) {
  std::error_code code;
  std::filesystem::remove_all(path, code);
  if (code) return failure("remove", path, code.value());
  return {};
}

bool exists(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;  // a link that leads nowhere is there, too
}

namespace {

/// The longest part of a path that exists.
std::string existing_part(const std::string& path) {
  std::string place = path;
  while (!exists(place) && place != directory_of(place)) place = directory_of(place);
  return place;
}

}  // namespace

bool same_disk(const std::string& a, const std::string& b) {
  struct stat first {};
  struct stat second {};
  return ::stat(existing_part(a).c_str(), &first) == 0 &&
         ::stat(existing_part(b).c_str(), &second) == 0 && first.st_dev == second.st_dev;
}

Result<std::uint64_t> free_space(const std::string& path) {
  const std::string place = existing_part(path);
  struct statvfs status {};
  if (::statvfs(place.c_str(), &status) != 0) return failure("find the free space", place, errno);
  return std::uint64_t{status.f_bavail} * status.f_frsize;
}

std::string directory_of(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

bool is_store_name(std::string_view path) {
  while (path.ends_with('/')) path.remove_suffix(1);
  return path.ends_with(".pss");
}

Result<std::vector<std::byte>> read_whole(const std::string& path, std::uint64_t limit) {
  PSS_ASSIGN(const File file, File::open(path));
  PSS_ASSIGN(const std::uint64_t size, file.size());
  if (size > limit)
    return Error{Fault::kBadInput,
                 fmt::format("{}: found {} bytes, expected at most {}", path, size, limit)};
  std::vector<std::byte> bytes(size);
  PSS_TRY(file.read(0, bytes));
  return bytes;
}

Result<void> replace_file(const std::string& path, std::span<const std::byte> bytes) {
  PSS_ASSIGN(OutputFile file, OutputFile::create(path, true));
  PSS_TRY(file.append(bytes));
  return file.finish();
}

}  // namespace pss
