#include "io/file/output_file.h"

#include <fmt/format.h>

#include <cassert>
#include <utility>

#include "io/file/disk.h"

namespace pss {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 20;

}  // namespace

Result<void> check_replaceable(const std::string& path, bool overwrite) {
  if (is_directory(path))
    return Error{Fault::kFailed, fmt::format("{}: is a directory; name a file in it", path)};
  if (overwrite || !exists(path)) return {};
  return Error{Fault::kFailed, fmt::format("{}: exists; use --overwrite to replace it", path)};
}

OutputFile::OutputFile(File file, std::string path, const OutputRules& rules,
                       std::optional<OutputLock> lock)
    : lock_(std::move(lock)), path_(std::move(path)), rules_(rules), file_(std::move(file)) {
  buffer_.reserve(kBufferSize);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : lock_(std::move(other.lock_)),
      path_(std::move(other.path_)),
      rules_(std::move(other.rules_)),
      file_(std::move(other.file_)),
      hasher_(std::move(other.hasher_)),
      buffer_(std::move(other.buffer_)),
      position_(other.position_),
      finished_(std::exchange(other.finished_, true)) {}

OutputFile::~OutputFile() {
  if (!finished_) disk::remove_file(file_.path());  // made by this object, under its own lock
}

Result<OutputFile> OutputFile::create(const std::string& path, const OutputRules& rules) {
  std::optional<OutputLock> own;
  if (!rules.lock) {
    PSS_ASSIGN(OutputLock taken, OutputLock::take(path));
    own.emplace(std::move(taken));
  }
  PSS_TRY(check_replaceable(path, rules.overwrite));
  PSS_ASSIGN(File file, File::create((own ? *own : *rules.lock).temporary(), path));
  return OutputFile(std::move(file), path, rules, std::move(own));
}

Result<void> OutputFile::append(std::span<const std::byte> bytes) {
  if (buffer_.size() + bytes.size() > kBufferSize) PSS_TRY(flush());
  position_ += bytes.size();
  if (bytes.size() > kBufferSize) return write_through(position_ - bytes.size(), bytes);
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  return {};
}

Result<void> OutputFile::append(std::string_view text) {
  return append(std::as_bytes(std::span(text)));
}

Result<void> OutputFile::patch(std::uint64_t offset, std::span<const std::byte> bytes) {
  assert(offset + bytes.size() <= position_);
  PSS_TRY(flush());
  hasher_.patched(offset, bytes.size());
  return file_.write(offset, bytes);
}

Result<void> OutputFile::write_through(std::uint64_t offset, std::span<const std::byte> bytes) {
  PSS_TRY(file_.write(offset, bytes));
  if (rules_.before_rename) hasher_.append(bytes);  // nobody else asks
  return {};
}

Result<void> OutputFile::flush() {
  PSS_TRY(write_through(position_ - buffer_.size(), buffer_));
  buffer_.clear();
  return {};
}

Result<void> OutputFile::tell_before_rename() {
  if (!rules_.before_rename) return {};
  PSS_ASSIGN(const FileContent content, hasher_.finish(file_));
  return rules_.before_rename({file_.path(), content});
}

Result<void> OutputFile::finish() {
  PSS_TRY(flush());
  PSS_TRY(file_.sync());
  PSS_TRY(tell_before_rename());
  PSS_TRY(rules_.overwrite ? rename_file(file_.path(), path_)
                           : rename_to_free_name(file_.path(), path_));
  finished_ = true;
  return {};
}

}  // namespace pss
