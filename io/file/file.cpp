#include "io/file/file.h"

#include <fmt/format.h>

#include <cerrno>
#include <limits>
#include <utility>

#include "io/file/disk.h"
#include "io/file/disk_failure.h"

namespace pss {
namespace {

constexpr std::uint64_t kLargestOffset = std::numeric_limits<std::int64_t>::max();

using disk::failure;

disk::Outcome open_descriptor(const std::string& path, disk::Open how) {
  return disk::uninterrupted([&] { return disk::open(path, how); });
}

/// Of a name in a folder of pss's own.
Error in_the_way(const std::string& path) {
  return {Fault::kFailed, fmt::format("{}: found a link or no regular file, expected a file of "
                                      "pss's own, with one name; move it elsewhere",
                                      path)};
}

bool past_the_largest(std::uint64_t offset, std::size_t size) {
  return offset > kLargestOffset || size > kLargestOffset - offset;
}

}  // namespace

File::File(std::int64_t descriptor, std::string path, std::string called)
    : descriptor_(static_cast<int>(descriptor)),
      path_(std::move(path)),
      called_(std::move(called)) {}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      called_(std::move(other.called_)),
      lost_(other.lost_) {}

File& File::operator=(File&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  std::swap(called_, other.called_);
  std::swap(lost_, other.lost_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0) disk::close(descriptor_);
}

Result<File> File::open(const std::string& path) {
  const disk::Outcome descriptor = open_descriptor(path, disk::Open::kRead);
  if (descriptor < 0) return failure("open", path, descriptor);
  File file(descriptor, path, path);
  disk::Status status;
  if (const auto outcome = disk::status(file.descriptor_, status); outcome < 0)
    return failure("open", path, outcome);
  if (status.kind == disk::Kind::kDirectory) return failure("read as a file", path, -EISDIR);
  if (status.kind != disk::Kind::kFile)
    return Error{Fault::kFailed, fmt::format("{}: is no regular file; pss reads files by position, "
                                             "so save its content to a file first",
                                             path)};
  return file;
}

Result<File> File::create(const std::string& path, const std::string& called) {
  const disk::Outcome descriptor = open_descriptor(path, disk::Open::kCreateNew);
  if (descriptor < 0) return failure("create", path, descriptor);
  return File(descriptor, path, called);
}

Result<File> File::create_anew(const std::string& path) {
  disk::Status status;
  const bool there = disk::status(path, disk::Links::kKeep, status) == 0;
  if (there && status.kind != disk::Kind::kFile) return in_the_way(path);
  if (there) PSS_TRY(remove_file(path));
  return create(path);
}

Result<File> File::open_to_write(const std::string& path) {
  const disk::Outcome descriptor = open_descriptor(path, disk::Open::kReadWrite);
  if (descriptor == -ELOOP) return in_the_way(path);
  if (descriptor < 0) return failure("open for writing", path, descriptor);
  File file(descriptor, path, path);
  disk::Status status;
  if (const auto outcome = disk::status(file.descriptor_, status); outcome < 0)
    return failure("open for writing", path, outcome);
  if (status.kind != disk::Kind::kFile || status.links != 1) return in_the_way(path);
  return file;
}

Result<FileState> File::state() const {
  disk::Status status;
  if (const auto outcome = disk::status(descriptor_, status); outcome < 0)
    return failure("find the size", called_, outcome);
  return FileState{status.size, status.modified_ns};
}

Result<std::uint64_t> File::size() const {
  PSS_ASSIGN(const FileState found, state());
  return found.size;
}

Result<std::size_t> File::read_some(std::uint64_t offset, std::span<std::byte> out) const {
  std::size_t done = 0;
  while (done < out.size() && !past_the_largest(offset + done, out.size() - done)) {
    const disk::Outcome got = disk::uninterrupted(
        [&] { return disk::read(descriptor_, offset + done, out.subspan(done)); });
    if (got < 0) return failure(fmt::format("read at offset {}", offset + done), called_, got);
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
                           called_, offset, found, out.size())};
}

Result<void> File::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (lost_) return failure("write after a failed sync", called_, -EIO);
  if (past_the_largest(offset, bytes.size())) return failure("write", called_, -EFBIG);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const disk::Outcome put = disk::uninterrupted(
        [&] { return disk::write(descriptor_, offset + done, bytes.subspan(done)); });
    if (put <= 0)
      return failure(fmt::format("write at offset {}", offset + done), called_,
                     put < 0 ? put : -ENOSPC);
    done += static_cast<std::size_t>(put);
  }
  return {};
}

Result<void> File::truncate(std::uint64_t size) {
  if (size > kLargestOffset) return failure("resize", called_, -EFBIG);
  const disk::Outcome outcome =
      disk::uninterrupted([&] { return disk::truncate(descriptor_, size); });
  if (outcome < 0) return failure("resize", called_, outcome);
  return {};
}

Result<void> File::sync() {
  if (lost_) return failure("sync again after a failed sync", called_, -EIO);
  const disk::Outcome outcome = disk::sync(descriptor_);
  if (outcome == 0) return {};
  // The kernel may have dropped the dirty pages: a second sync would succeed and lie.
  lost_ = true;
  return failure("sync", called_, outcome);
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

std::string replacement_of(const std::string& path) { return path + ".new"; }

Result<void> replace_file(const std::string& path, std::span<const std::byte> bytes) {
  return replace_file(path, {bytes}, replacement_of(path));
}

Result<void> replace_file(const std::string& path,
                          std::initializer_list<std::span<const std::byte>> pieces,
                          const std::string& temporary) {
  PSS_ASSIGN(File file, File::create_anew(temporary));
  std::uint64_t size = 0;
  for (const std::span<const std::byte> piece : pieces) {
    PSS_TRY(file.write(size, piece));
    size += piece.size();
  }
  PSS_TRY(file.sync());
  return rename_file(file.path(), path);
}

}  // namespace pss
