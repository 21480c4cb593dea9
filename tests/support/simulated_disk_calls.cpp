// The calls of io/file/disk.h, made to the simulated disk.

#include <cerrno>
#include <mutex>
#include <utility>

#include "tests/support/simulated_disk_state.h"

namespace pss::disk {
namespace {

using test::Call;
using test::NodePtr;

/// One call: locked, and what the fault decides about it.
struct Entered {
  test::SimulatedDisk::State& disk;
  std::unique_lock<std::mutex> lock;
  int fault;

  Entered(Call call, const std::string& path)
      : disk(test::current_disk()), lock(disk.mutex), fault(disk.before(call, path)) {}
  Entered(Call call, int descriptor)
      : disk(test::current_disk()),
        lock(disk.mutex),
        fault(disk.before(call, disk.path_of(descriptor))) {}

  bool failed() const { return fault > 0; }
  Outcome error() const { return -fault; }
  std::size_t count(std::size_t size) const {
    return fault == test::kShort && size > 1 ? size / 2 : size;
  }
};

void describe(const test::Node& node, Status& out) {
  out.kind = node.directory ? Kind::kDirectory : Kind::kFile;
  out.size = node.bytes.size();
  out.modified_ns = node.modified;
  out.device = 1;
  out.inode = node.inode;
}

Outcome rename(Entered& entered, const std::string& from, const std::string& to, bool replace) {
  if (entered.failed()) return entered.error();
  const auto [old_folder, old_name] = test::split(from);
  const auto [folder, name] = test::split(to);
  const NodePtr source = entered.disk.find(old_folder), target = entered.disk.find(folder);
  if (!entered.disk.find(from) || !target) return -ENOENT;
  if (const NodePtr there = entered.disk.find(to)) {
    if (!replace) return -EEXIST;
    if (there->directory && !there->names.empty()) return -ENOTEMPTY;
  }
  entered.disk.move(source, old_name, target, name);
  entered.disk.count_bytes();
  return 0;
}

}  // namespace

Outcome open(const std::string& path, Open how) {
  Entered entered(Call::kOpen, path);
  if (entered.failed()) return entered.error();
  NodePtr file = entered.disk.find(path);
  if (file && how == Open::kCreateNew) return -EEXIST;
  if (file && file->directory) return how == Open::kRead ? entered.disk.give(file, path) : -EISDIR;
  if (!file) {
    if (how != Open::kCreateNew) return -ENOENT;
    const auto [folder, name] = test::split(path);
    const NodePtr directory = entered.disk.find(folder);
    if (!directory) return -ENOENT;
    file = entered.disk.make_node(false);
    entered.disk.link(directory, name, file);
  }
  return entered.disk.give(file, path);
}

void close(int descriptor) {
  test::SimulatedDisk::State& disk = test::current_disk();
  const std::scoped_lock lock(disk.mutex);
  std::erase_if(disk.locks, [&](const auto& held) { return held.second == descriptor; });
  disk.open_files.erase(descriptor);
}

Outcome read(int descriptor, std::uint64_t offset, std::span<std::byte> out) {
  Entered entered(Call::kRead, descriptor);
  if (entered.failed()) return entered.error();
  const test::Bytes& bytes = entered.disk.file_of(descriptor).bytes;
  if (offset >= bytes.size()) return 0;
  const std::size_t count =
      entered.count(std::min<std::uint64_t>(out.size(), bytes.size() - offset));
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), count, out.begin());
  return static_cast<Outcome>(count);
}

Outcome write(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes) {
  Entered entered(Call::kWrite, descriptor);
  if (entered.failed()) return entered.error();
  return entered.disk.write(entered.disk.file_of(descriptor), offset,
                            bytes.first(entered.count(bytes.size())));
}

Outcome truncate(int descriptor, std::uint64_t size) {
  Entered entered(Call::kTruncate, descriptor);
  if (entered.failed()) return entered.error();
  entered.disk.resize(entered.disk.file_of(descriptor), size);
  return 0;
}

Outcome sync(int descriptor) {
  Entered entered(Call::kSync, descriptor);
  const NodePtr file = entered.disk.open_files.at(descriptor).file;
  if (entered.failed()) {
    if (!entered.disk.crashed) entered.disk.lose(file, descriptor);
    return entered.error();
  }
  if (std::exchange(entered.disk.open_files.at(descriptor).to_fail, false)) return -EIO;
  if (entered.disk.lies(Call::kSync, entered.disk.path_of(descriptor))) return 0;
  if (!file->lost) test::settle(*file);
  return 0;
}

Outcome lock(int descriptor, Lock /*kind*/) {
  Entered entered(Call::kLock, descriptor);
  if (entered.failed()) return entered.error();
  const auto [held, taken] =
      entered.disk.locks.try_emplace(&entered.disk.file_of(descriptor), descriptor);
  return taken || held->second == descriptor ? 0 : -EWOULDBLOCK;
}

Outcome lock_holder(int /*descriptor*/) { return -ESRCH; }

Outcome status(int descriptor, Status& out) {
  Entered entered(Call::kStatus, descriptor);
  if (entered.failed()) return entered.error();
  describe(entered.disk.file_of(descriptor), out);
  return 0;
}

Outcome status(const std::string& path, Links /*links*/, Status& out) {
  Entered entered(Call::kStatus, path);
  if (entered.failed()) return entered.error();
  const NodePtr node = entered.disk.find(path);
  if (!node) return -ENOENT;
  describe(*node, out);
  return 0;
}

Outcome list(const std::string& path, std::vector<std::string>& names) {
  Entered entered(Call::kList, path);
  if (entered.failed()) return entered.error();
  const NodePtr directory = entered.disk.find(path);
  if (!directory) return -ENOENT;
  for (const auto& [name, node] : directory->names) names.push_back(name);
  return 0;
}

Outcome match(const std::string& /*pattern*/, std::vector<std::string>& /*paths*/) {
  return -ENOENT;  // no job of these tests names its inputs by a pattern
}

Outcome make_directory(const std::string& path) {
  Entered entered(Call::kMakeDirectory, path);
  if (entered.failed()) return entered.error();
  const auto [folder, name] = test::split(path);
  const NodePtr parent = entered.disk.find(folder);
  if (!parent) return -ENOENT;
  if (parent->names.contains(name)) return -EEXIST;
  entered.disk.link(parent, name, entered.disk.make_node(true));
  return 0;
}

Outcome remove_directory(const std::string& path) {
  Entered entered(Call::kRemoveDirectory, path);
  if (entered.failed()) return entered.error();
  const NodePtr node = entered.disk.find(path);
  if (!node) return -ENOENT;
  if (!node->names.empty()) return -ENOTEMPTY;
  const auto [folder, name] = test::split(path);
  entered.disk.unlink(entered.disk.find(folder), name);
  return 0;
}

Outcome remove_file(const std::string& path) {
  Entered entered(Call::kRemoveFile, path);
  if (entered.failed()) return entered.error();
  if (!entered.disk.find(path)) return -ENOENT;
  const auto [folder, name] = test::split(path);
  entered.disk.unlink(entered.disk.find(folder), name);
  entered.disk.count_bytes();
  return 0;
}

Outcome rename(const std::string& from, const std::string& to) {
  Entered entered(Call::kRename, from);
  return rename(entered, from, to, true);
}

Outcome rename_to_free(const std::string& from, const std::string& to) {
  Entered entered(Call::kRename, from);
  return rename(entered, from, to, false);
}

Outcome exchange(const std::string& a, const std::string& b) {
  Entered entered(Call::kRename, a);
  if (entered.failed()) return entered.error();
  const auto [folder, name] = test::split(a);
  const auto [other_folder, other_name] = test::split(b);
  if (!entered.disk.find(a) || !entered.disk.find(b)) return -ENOENT;
  entered.disk.swap(entered.disk.find(folder), name, entered.disk.find(other_folder), other_name);
  return 0;
}

Outcome sync_directory(const std::string& path) {
  Entered entered(Call::kSyncDirectory, path);
  if (entered.failed()) return entered.error();
  const NodePtr directory = entered.disk.find(path);
  if (!directory) return -ENOENT;
  if (!entered.disk.lies(Call::kSyncDirectory, path)) entered.disk.sync_names(directory);
  return 0;
}

Outcome free_space(const std::string& path, std::uint64_t& bytes) {
  Entered entered(Call::kFreeSpace, path);
  if (entered.failed()) return entered.error();
  // A disk that fills up while the job runs: it looked empty when the job asked.
  bytes = std::uint64_t{1} << 40;
  return 0;
}

std::string canonical(const std::string& path) { return path; }

}  // namespace pss::disk
