#include "io/file_lock.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "io/disk.h"

namespace pss {
namespace {

std::string holder_text(int descriptor) {
  std::string text(255, '\0');
  const disk::Outcome size = disk::read(descriptor, 0, std::as_writable_bytes(std::span(text)));
  return size > 0 ? text.substr(0, static_cast<std::size_t>(size)) : "another process";
}

disk::Outcome write_holder(int descriptor) {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  const std::string text = fmt::format("process {} on {}", getpid(), host);
  const disk::Outcome outcome = disk::uninterrupted([&] { return disk::truncate(descriptor, 0); });
  if (outcome < 0) return outcome;
  return disk::uninterrupted(
      [&] { return disk::write(descriptor, 0, std::as_bytes(std::span(text))); });
}

Error failure(const std::string& path, disk::Outcome outcome) {
  const std::error_code code(static_cast<int>(-outcome), std::generic_category());
  return {Fault::kFailed, fmt::format("{}: cannot lock: {}", path, code.message())};
}

}  // namespace

Result<FileLock> FileLock::take(const std::string& path) {
  const disk::Outcome descriptor =
      disk::uninterrupted([&] { return disk::open(path, disk::Open::kOpenOrCreate); });
  if (descriptor < 0) return failure(path, descriptor);
  FileLock lock(static_cast<int>(descriptor));
  if (const auto outcome = disk::lock(lock.descriptor_, disk::Lock::kExclusive); outcome < 0) {
    if (outcome != -EWOULDBLOCK) return failure(path, outcome);
    return Error{Fault::kFailed, fmt::format("{}: held by {}; wait for it to end", path,
                                             holder_text(lock.descriptor_))};
  }
  if (const auto outcome = write_holder(lock.descriptor_); outcome < 0)
    return failure(path, outcome);
  return lock;
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock::~FileLock() {
  if (descriptor_ >= 0) disk::close(descriptor_);
}

std::optional<std::string> lock_holder(const std::string& path) {
  const disk::Outcome opened = disk::open(path, disk::Open::kReadWrite);
  if (opened < 0) return std::nullopt;
  const int descriptor = static_cast<int>(opened);
  std::optional<std::string> holder;
  if (disk::lock(descriptor, disk::Lock::kShared) == -EWOULDBLOCK) holder = holder_text(descriptor);
  disk::close(descriptor);
  return holder;
}

}  // namespace pss
