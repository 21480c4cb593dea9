// OutputFile of io/file.h: what makes a file appear under its name only when it is complete.

#include <fmt/format.h>

#include <cassert>
#include <cerrno>
#include <system_error>
#include <utility>

#include "io/disk.h"
#include "io/file.h"

namespace pss {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 20;

std::string part_of(const std::string& path) { return path + ".part"; }

Error exists_already(const std::string& path) {
  return {Fault::kFailed, fmt::format("{}: exists; use --overwrite to replace it", path)};
}

Error rename_failure(const std::string& from, const std::string& to, disk::Outcome outcome) {
  const std::error_code code(static_cast<int>(-outcome), std::generic_category());
  return {Fault::kFailed, fmt::format("{}: cannot rename to {}: {}", from, to, code.message())};
}

/// Gives a file its name, but never takes that name from another file that came meanwhile.
Result<void> rename_to_free_name(const std::string& from, const std::string& to) {
  const disk::Outcome outcome = disk::rename_to_free(from, to);
  if (outcome == 0) return sync_directory(directory_of(to));
  if (outcome == -EEXIST) return exists_already(to);
  // Not every file system knows the call.
  const bool unknown = outcome == -EINVAL || outcome == -ENOSYS || outcome == -EOPNOTSUPP;
  if (unknown && exists(to)) return exists_already(to);
  return unknown ? rename_file(from, to) : rename_failure(from, to, outcome);
}

}  // namespace

OutputFile::OutputFile(File file, std::string path, bool overwrite, BeforeRename before_rename)
    : path_(std::move(path)),
      overwrite_(overwrite),
      before_rename_(std::move(before_rename)),
      file_(std::move(file)) {
  buffer_.reserve(kBufferSize);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      overwrite_(other.overwrite_),
      before_rename_(std::move(other.before_rename_)),
      file_(std::move(other.file_)),
      buffer_(std::move(other.buffer_)),
      position_(other.position_),
      finished_(std::exchange(other.finished_, true)) {}

OutputFile::~OutputFile() {
  if (!finished_) disk::remove_file(file_.path());
}

Result<OutputFile> OutputFile::create(const std::string& path, bool overwrite,
                                      BeforeRename before_rename) {
  if (is_directory(path))
    return Error{Fault::kFailed, fmt::format("{}: is a directory; name a file in it", path)};
  if (!overwrite && exists(path)) return exists_already(path);
  PSS_ASSIGN(File file, File::create(part_of(path)));
  return OutputFile(std::move(file), path, overwrite, std::move(before_rename));
}

Result<void> OutputFile::append(std::span<const std::byte> bytes) {
  if (buffer_.size() + bytes.size() > kBufferSize) PSS_TRY(flush());
  if (bytes.size() > kBufferSize) {
    PSS_TRY(file_.write(position_, bytes));
  } else {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  position_ += bytes.size();
  return {};
}

Result<void> OutputFile::append(std::string_view text) {
  return append(std::as_bytes(std::span(text)));
}

Result<void> OutputFile::patch(std::uint64_t offset, std::span<const std::byte> bytes) {
  assert(offset + bytes.size() <= position_);
  PSS_TRY(flush());
  return file_.write(offset, bytes);
}

Result<void> OutputFile::flush() {
  PSS_TRY(file_.write(position_ - buffer_.size(), buffer_));
  buffer_.clear();
  return {};
}

Result<void> OutputFile::finish() {
  PSS_TRY(flush());
  PSS_TRY(file_.sync());
  if (before_rename_) PSS_TRY(before_rename_(file_.path()));
  PSS_TRY(overwrite_ ? rename_file(file_.path(), path_) : rename_to_free_name(file_.path(), path_));
  finished_ = true;
  return {};
}

}  // namespace pss
