// io/disk.h by the kernel: the only file that includes its headers.

#include <fcntl.h>
#include <glob.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "io/disk.h"

namespace pss::disk {
namespace {

Outcome outcome(std::int64_t result) { return result < 0 ? -errno : result; }

int flags_of(Open how) {
  switch (how) {
    case Open::kRead:
      return O_RDONLY | O_NONBLOCK;  // or a pipe that nobody writes would stop us
    case Open::kCreate:
      return O_RDWR | O_CREAT | O_TRUNC;
    case Open::kOpenOrCreate:
      return O_RDWR | O_CREAT;
    case Open::kReadWrite:
      return O_RDWR;
  }
  return O_RDONLY;
}

Outcome translate(int result, const struct stat& from, Status& out) {
  if (result != 0) return -errno;
  out.kind = S_ISREG(from.st_mode)   ? Kind::kFile
             : S_ISDIR(from.st_mode) ? Kind::kDirectory
                                     : Kind::kOther;
  out.size = static_cast<std::uint64_t>(from.st_size);
  out.modified_ns = from.st_mtim.tv_sec * 1'000'000'000 + from.st_mtim.tv_nsec;
  out.device = from.st_dev;
  out.inode = from.st_ino;
  return 0;
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

Outcome status(int descriptor, Status& out) {
  struct stat found {};
  return translate(::fstat(descriptor, &found), found, out);
}

Outcome status(const std::string& path, Links links, Status& out) {
  struct stat found {};
  const int result =
      links == Links::kFollow ? ::stat(path.c_str(), &found) : ::lstat(path.c_str(), &found);
  return translate(result, found, out);
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
