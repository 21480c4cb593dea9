#include "io/file/output_lock.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <span>
#include <utility>

#include "io/file/disk.h"
#include "io/file/disk_failure.h"
#include "io/file/file.h"
#include "io/file/hash.h"

namespace pss {
namespace {

/// So much of a name is kept: with what is added it stays below the 255 bytes that names may have.
constexpr std::size_t kLongestName = 200;

using disk::failure;

/// A hidden name in the folder of `path`: ".NAME.SUFFIX".
std::string beside(const std::string& path, std::string_view suffix) {
  const std::size_t slash = path.find_last_of('/');
  const std::size_t start = slash == std::string::npos ? 0 : slash + 1;
  std::string name = path.substr(start);
  if (name.size() > kLongestName)  // a hash tells names apart that are not kept whole
    name = fmt::format("{}-{:016x}", name.substr(0, kLongestName - 17),
                       hash64(std::as_bytes(std::span(name))));
  return fmt::format("{}.{}.{}", path.substr(0, start), name, suffix);
}

std::string holder_text(disk::Outcome process) {
  if (process <= 0) return "another process, perhaps on another machine";
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  return fmt::format("process {} on {}", process, host);
}

Error in_the_way(const std::string& path) {
  return {Fault::kFailed,
          fmt::format("{}: is in the way, and not what a lock of pss is, an empty file with one "
                      "name; move it elsewhere",
                      path)};
}

/// A lock file, just made or left by a process that was killed.
struct LockFile {
  int descriptor = -1;
  bool made = false;
};

Result<LockFile> open_lock(const std::string& path) {
  const std::string name = lock_name_of(path);
  for (;;) {
    disk::Outcome opened =
        disk::uninterrupted([&] { return disk::open(name, disk::Open::kCreateNew); });
    if (opened >= 0) return LockFile{static_cast<int>(opened), true};
    if (opened != -EEXIST) return failure("write in its folder", path, opened);
    opened = disk::uninterrupted([&] { return disk::open(name, disk::Open::kReadWrite); });
    if (opened >= 0) return LockFile{static_cast<int>(opened), false};
    if (opened == -ELOOP || opened == -EISDIR) return in_the_way(name);
    if (opened != -ENOENT) return failure("open", name, opened);
  }
}

struct Attempt {
  disk::Outcome taken = 0;
  disk::Outcome holder = 0;  ///< where it is taken already
};

/// A holder that nobody knows may have just ended: then the lock is free.
Attempt try_lock(int descriptor) {
  constexpr int kTries = 3;
  Attempt attempt;
  for (int tried = 0; tried < kTries && attempt.holder <= 0; ++tried) {
    attempt.taken =
        disk::uninterrupted([&] { return disk::lock(descriptor, disk::Lock::kExclusive); });
    if (attempt.taken != -EWOULDBLOCK) break;
    attempt.holder = disk::lock_holder(descriptor);
  }
  return attempt;
}

/// Names that are too long, and folders that are none, are told from a name that is free.
Result<void> check_name(const std::string& path) {
  disk::Status there;
  const disk::Outcome outcome = disk::status(path, disk::Links::kKeep, there);
  if (outcome == 0 && there.mounted)
    return Error{Fault::kFailed, fmt::format("{}: is a mount point, which no file can replace; "
                                             "choose another name",
                                             path)};
  return outcome < 0 && outcome != -ENOENT ? failure("write", path, outcome) : Result<void>();
}

bool is_lock_file(const disk::Status& status) {
  return status.kind == disk::Kind::kFile && status.size == 0 && status.links <= 1;
}

/// Whether the name still leads to the file that was locked: its last holder may have removed it.
bool is_still(const std::string& path, const disk::Status& locked) {
  disk::Status now;
  return disk::status(path, disk::Links::kKeep, now) == 0 && now.inode == locked.inode &&
         now.device == locked.device;
}

/// Removes what a process that was killed left under its temporary name.
Result<void> remove_left_over(const std::string& path) {
  disk::Status status;
  if (disk::status(path, disk::Links::kKeep, status) == -ENOENT) return {};
  const bool directory = status.kind == disk::Kind::kDirectory;
  const disk::Outcome outcome = directory ? disk::remove_directory(path) : disk::remove_file(path);
  return outcome < 0 ? failure("remove", path, outcome) : Result<void>();
}

}  // namespace

OutputLock::OutputLock(int descriptor, std::string path)
    : path_(std::move(path)), descriptor_(descriptor) {}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  if (!temporary_.empty()) disk::remove_file(lock_name_of(path_));  // ours while it is locked
  disk::close(descriptor_);
}

Result<OutputLock> OutputLock::take(const std::string& path) {
  PSS_TRY(check_name(path));
  for (;;) {
    PSS_ASSIGN(const LockFile file, open_lock(path));
    OutputLock lock(file.descriptor, path);
    PSS_ASSIGN(const bool held, lock.hold(file.made));
    if (held) return lock;
  }
}

Result<bool> OutputLock::hold(bool made) {
  const std::string name = lock_name_of(path_);
  disk::Status status;
  if (const auto outcome = disk::status(descriptor_, status); outcome < 0)
    return failure("lock", path_, outcome);
  if (!is_lock_file(status)) return in_the_way(name);
  const Attempt attempt = try_lock(descriptor_);
  const disk::Outcome taken = attempt.taken;
  if (taken == -EWOULDBLOCK)
    return Error{Fault::kFailed, fmt::format("{}: is being written by {}; wait for it to end",
                                             path_, holder_text(attempt.holder))};
  if (taken < 0 && made) disk::remove_file(name);
  if (taken < 0) return failure("lock", path_, taken);
  if (!is_still(name, status)) return false;
  const std::string temporary = beside(path_, fmt::format("{}.pss-part", status.inode));
  // Order: the lock file's name is durable before anything is written under the temporary name.
  // Otherwise a power cut could leave a temporary that nobody knows.
  // Whoever made it may have been killed before that, so it is done again.
  if (auto durable = sync_directory(directory_of(path_)); !durable) {
    if (made) disk::remove_file(name);
    return std::move(durable).error();
  }
  if (!made) PSS_TRY(remove_left_over(temporary));
  temporary_ = temporary;
  return true;
}

std::string lock_name_of(const std::string& path) { return beside(path, "pss-lock"); }

std::optional<std::string> lock_holder(const std::string& path) {
  const disk::Outcome opened = disk::open(lock_name_of(path), disk::Open::kReadWrite);
  if (opened < 0) return std::nullopt;
  const int descriptor = static_cast<int>(opened);
  // Asked, and not tried: a lock taken here for a moment could turn a job away that begins now.
  const disk::Outcome process = disk::lock_holder(descriptor);
  disk::close(descriptor);
  return process > 0 ? std::optional(holder_text(process)) : std::nullopt;
}

}  // namespace pss
