// io/file/disk.h by the kernel: the only file that includes its headers.

#include <fcntl.h>
#include <glob.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <system_error>

#include "io/file/disk.h"

namespace pss::disk {
namespace {

Outcome outcome(std::int64_t result) { return result < 0 ? -errno : result; }

int flags_of(Open how) {
  switch (how) {
    case Open::kRead:
      return O_RDONLY | O_NONBLOCK;  // or a pipe that nobody writes would stop us
    case Open::kCreateNew:
      return O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW;
    case Open::kReadWrite:
      return O_RDWR | O_NOFOLLOW | O_NONBLOCK;
  }
  return O_RDONLY;
}

/// Since 1970; what does not fit (beyond the years 1678 to 2262) is the nearest that does.
std::int64_t nanoseconds(std::int64_t seconds, std::uint32_t rest) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max() / kSecond - 1;
  return std::clamp(seconds, -kMost, kMost) * kSecond + rest;
}

/// What the kernel says of a file, by descriptor (path ""), or by path.
Outcome find_status(int folder, const char* path, int flags, Status& out) {
  struct statx found {};
  if (::statx(folder, path, flags, STATX_BASIC_STATS, &found) != 0) return -errno;
  out.kind = S_ISREG(found.stx_mode)   ? Kind::kFile
             : S_ISDIR(found.stx_mode) ? Kind::kDirectory
             : S_ISLNK(found.stx_mode) ? Kind::kLink
                                       : Kind::kOther;
  out.size = found.stx_size;
  out.modified_ns = nanoseconds(found.stx_mtime.tv_sec, found.stx_mtime.tv_nsec);
  out.device = makedev(found.stx_dev_major, found.stx_dev_minor);
  out.inode = found.stx_ino;
  out.links = found.stx_nlink;
  out.mounted = (found.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
  return 0;
}

/// "1: FLOCK  ADVISORY  WRITE 5671 fe:00:10952733 0 EOF": the process, where the lock is an
/// exclusive one of flock() on a file of this number.
Outcome holder_in(const std::string& line, std::uint64_t inode) {
  std::istringstream words(line);
  std::string number, kind, mode, access, file;
  std::int64_t process = 0;
  words >> number >> kind >> mode >> access >> process >> file;
  const std::size_t colon = file.find_last_of(':');
  if (!words || kind != "FLOCK" || access != "WRITE" || process <= 0 || colon == std::string::npos)
    return -ESRCH;
  return file.substr(colon + 1) == std::to_string(inode) ? process : -ESRCH;
}

}  // namespace

Outcome open(const std::string& path, Open how) {
  return outcome(::open(path.c_str(), flags_of(how) | O_CLOEXEC, 0666));
}

void close(int descriptor) { ::close(descriptor); }

Outcome read(int descriptor, std::uint64_t offset, std::span<std::byte> out) {
  return outcome(::pread(descriptor, out.data(), out.size(), static_cast<off_t>(offset)));
}

Outcome write(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes) {
  return outcome(::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset)));
}

Outcome truncate(int descriptor, std::uint64_t size) {
  return outcome(::ftruncate(descriptor, static_cast<off_t>(size)));
}

Outcome sync(int descriptor) { return outcome(::fsync(descriptor)); }

Outcome lock(int descriptor, Lock kind) {
  return outcome(::flock(descriptor, (kind == Lock::kShared ? LOCK_SH : LOCK_EX) | LOCK_NB));
}

Outcome lock_holder(int descriptor) {
  Status file;
  if (const Outcome found = status(descriptor, file); found < 0) return found;
  // The device is not compared: file systems with subvolumes give another one here.
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);)
    if (const Outcome process = holder_in(line, file.inode); process > 0) return process;
  return -ESRCH;
}

Outcome status(int descriptor, Status& out) {
  return find_status(descriptor, "", AT_EMPTY_PATH, out);
}

Outcome status(const std::string& path, Links links, Status& out) {
  return find_status(AT_FDCWD, path.c_str(), links == Links::kKeep ? AT_SYMLINK_NOFOLLOW : 0, out);
}

Outcome list(const std::string& path, std::vector<std::string>& names) {
  std::error_code code;
  std::filesystem::directory_iterator entry(path, code);
  for (; !code && entry != std::filesystem::directory_iterator(); entry.increment(code))
    names.push_back(entry->path().filename().string());
  return -code.value();
}

Outcome match(const std::string& pattern, std::vector<std::string>& paths) {
  glob_t found{};
  const int result = ::glob(pattern.c_str(), GLOB_ERR, nullptr, &found);
  if (result == 0) paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  if (result == GLOB_NOMATCH) return -ENOENT;
  return result == GLOB_NOSPACE ? -ENOMEM : result != 0 ? -EIO : 0;
}

Outcome make_directory(const std::string& path) { return outcome(::mkdir(path.c_str(), 0777)); }

Outcome remove_directory(const std::string& path) { return outcome(::rmdir(path.c_str())); }

Outcome remove_file(const std::string& path) { return outcome(::unlink(path.c_str())); }

Outcome rename(const std::string& from, const std::string& to) {
  return outcome(::rename(from.c_str(), to.c_str()));
}

Outcome rename_to_free(const std::string& from, const std::string& to) {
  return outcome(::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE));
}

Outcome exchange(const std::string& a, const std::string& b) {
  return outcome(::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE));
}

Outcome sync_directory(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return -errno;
  const Outcome result = sync(descriptor);
  ::close(descriptor);
  return result;
}

Outcome free_space(const std::string& path, std::uint64_t& bytes) {
  struct statvfs found {};
  if (::statvfs(path.c_str(), &found) != 0) return -errno;
  bytes = std::uint64_t{found.f_bavail} * found.f_frsize;
  return 0;
}

std::string canonical(const std::string& path) {
  std::error_code code;
  const auto whole = std::filesystem::weakly_canonical(path, code);
  return code ? path : whole.string();
}

}  // namespace pss::disk
