#include "tests/support/simulated_disk.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>

namespace pss::test {
namespace {

using Bytes = std::vector<std::byte>;
constexpr std::uint64_t kBlock = 512;  ///< what a disk writes whole or not at all

struct Range {
  std::uint64_t begin, end;
};

struct Node;
using NodePtr = std::shared_ptr<Node>;
using Names = std::map<std::string, NodePtr>;

/// A file or a directory, as programs see it and as a crash may leave it.
struct Node {
  bool directory = false;
  std::uint64_t inode = 0;
  Bytes bytes, durable;
  std::vector<Range> unsynced;  ///< written since the last sync
  bool lost = false;            ///< a sync failed: later ones say yes and do nothing, as Linux does
  std::int64_t modified = 0, durable_modified = 0;
  Names names, durable_names;
};

/// A change of names that is not durable yet: `apply` to what is durable.
struct NameChange {
  std::vector<NodePtr> directories;
  std::function<void()> apply;
};

std::pair<std::string, std::string> split(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  assert(slash != std::string::npos);
  return {path.substr(0, slash), path.substr(slash + 1)};  // no path here ends in a slash
}

/// Any size between two, at the end of a block or at either end.
std::uint64_t torn_size(std::uint64_t a, std::uint64_t b, std::mt19937_64& random) {
  const std::uint64_t low = std::min(a, b), high = std::max(a, b);
  if (random() % 3 == 0) return random() % 2 ? low : high;
  const std::uint64_t size = low + random() % (high - low + 1);
  return random() % 2 ? size : std::clamp(size / kBlock * kBlock, low, high);
}

void tear(Node& file, std::mt19937_64& random) {
  Bytes left = file.durable;
  left.resize(torn_size(file.durable.size(), file.bytes.size(), random));
  for (const Range& range : file.unsynced)
    for (std::uint64_t at = range.begin; at < range.end;) {
      const std::uint64_t end = std::min(range.end, (at / kBlock + 1) * kBlock);
      const std::uint64_t stop = std::min<std::uint64_t>({end, left.size(), file.bytes.size()});
      if (random() % 2 == 0 && at < stop)
        std::copy(file.bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  file.bytes.begin() + static_cast<std::ptrdiff_t>(stop),
                  left.begin() + static_cast<std::ptrdiff_t>(at));
      at = end;
    }
  file.bytes = std::move(left);
  if (random() % 2) file.modified = file.durable_modified;
}

void garble(Node& file, std::mt19937_64& random) {
  for (const Range& range : file.unsynced)
    for (std::uint64_t at = range.begin; at < std::min<std::uint64_t>(range.end, file.bytes.size());
         ++at)
      file.bytes[at] = static_cast<std::byte>(random() & 0xFF);
}

void settle(Node& file) {
  file.durable = file.bytes;
  file.durable_modified = file.modified;
  file.unsynced.clear();
  file.lost = false;
}

}  // namespace

bool changes(Call call) {
  return call != Call::kOpen && call != Call::kRead && call != Call::kLock &&
         call != Call::kStatus && call != Call::kList && call != Call::kFreeSpace;
}

const char* name_of(Call call) {
  constexpr const char* kNames[] = {"open",   "read",   "write",          "truncate",  "sync",
                                    "lock",   "status", "list",           "mkdir",     "rmdir",
                                    "unlink", "rename", "sync directory", "free space"};
  return kNames[static_cast<std::size_t>(call)];
}

struct SimulatedDisk::State {
  struct OpenFile {
    NodePtr file;
    std::string path;
  };

  mutable std::mutex mutex;
  NodePtr root = std::make_shared<Node>();
  std::vector<NameChange> pending;
  std::map<int, OpenFile> open_files;
  std::map<Node*, int> locks;  ///< held by the descriptor
  int next_descriptor = 3;
  std::uint64_t next_inode = 2;
  std::int64_t clock = 1'000'000'000;
  FaultAt fault;
  std::uint64_t calls = 0, changed = 0;
  std::uint64_t crash_at = std::numeric_limits<std::uint64_t>::max();
  bool crashed = false;
  std::uint64_t capacity = std::uint64_t{1} << 40;
  std::uint64_t used = 0, largest = 0;

  State() {
    root->directory = true;
    root->inode = 1;
  }

  NodePtr find(const std::string& path) const {
    NodePtr node = root;
    for (std::size_t at = 0; at < path.size();) {
      const std::size_t end = std::min(path.find('/', at), path.size());
      const std::string name = path.substr(at, end - at);
      at = end + 1;
      if (name.empty() || name == ".") continue;
      const auto found = node->names.find(name);
      if (!node->directory || found == node->names.end()) return nullptr;
      node = found->second;
    }
    return node;
  }

  /// 0, or what the call gives instead of doing anything. Called with the mutex held.
  int before(Call call, const std::string& path) {
    ++calls;
    if (changes(call) && ++changed == crash_at) crashed = true;
    if (crashed) return EIO;
    return fault ? fault(call, path) : 0;
  }

  /// A change that programs see at once and a crash may undo.
  void change_names(std::vector<NodePtr> directories, std::function<void(bool durable)> change) {
    change(false);
    pending.push_back({std::move(directories), [change] { change(true); }});
  }

  static Names& names_of(const NodePtr& directory, bool durable) {
    return durable ? directory->durable_names : directory->names;
  }

  void link(const NodePtr& directory, const std::string& name, const NodePtr& node) {
    change_names({directory}, [directory, name, node](bool durable) {
      names_of(directory, durable)[name] = node;
    });
  }

  void unlink(const NodePtr& directory, const std::string& name) {
    change_names({directory},
                 [directory, name](bool durable) { names_of(directory, durable).erase(name); });
  }

  void move(const NodePtr& from, const std::string& old, const NodePtr& to,
            const std::string& name) {
    const NodePtr node = from->names.at(old);
    change_names({from, to}, [=](bool durable) {
      names_of(from, durable).erase(old);
      names_of(to, durable)[name] = node;
    });
  }

  void sync_names(const NodePtr& directory) {
    std::vector<NameChange> rest;
    for (NameChange& change : pending)
      if (std::ranges::find(change.directories, directory) != change.directories.end())
        change.apply();
      else
        rest.push_back(std::move(change));
    pending = std::move(rest);
  }

  /// Every node that a path leads to.
  template <class Visit>
  static void each(const NodePtr& node, const Visit& visit) {
    visit(*node);
    for (const auto& [name, child] : node->names) each(child, visit);
  }

  NodePtr make_node(bool directory) {
    auto node = std::make_shared<Node>();
    node->directory = directory;
    node->inode = next_inode++;
    node->modified = clock += 1000;
    return node;
  }

  void count_bytes() {
    used = 0;
    each(root, [&](const Node& node) { used += node.bytes.size(); });
    largest = std::max(largest, used);
  }

  disk::Outcome give(const NodePtr& file, const std::string& path) {
    open_files[next_descriptor] = {file, path};
    return next_descriptor++;
  }

  Node& file_of(int descriptor) { return *open_files.at(descriptor).file; }

  /// Of a descriptor that a restart has closed: "".
  std::string path_of(int descriptor) const {
    const auto found = open_files.find(descriptor);
    return found == open_files.end() ? "" : found->second.path;
  }

  disk::Outcome write(Node& file, std::uint64_t offset, std::span<const std::byte> bytes) {
    const std::uint64_t room = capacity - std::min(capacity, used);
    const std::uint64_t there =
        file.bytes.size() - std::min<std::uint64_t>(file.bytes.size(), offset);
    const std::uint64_t count = std::min<std::uint64_t>(bytes.size(), there + room);
    if (count == 0 && !bytes.empty()) return -ENOSPC;
    const std::uint64_t end = offset + count;
    if (end > file.bytes.size()) {
      used += end - file.bytes.size();
      largest = std::max(largest, used);
      file.bytes.resize(end);
    }
    std::copy_n(bytes.begin(), count, file.bytes.begin() + static_cast<std::ptrdiff_t>(offset));
    file.unsynced.push_back({offset, end});
    file.modified = clock += 1000;
    return static_cast<disk::Outcome>(count);
  }

  void resize(Node& file, std::uint64_t size) {
    if (size > file.bytes.size()) file.unsynced.push_back({file.bytes.size(), size});
    file.bytes.resize(size);
    file.modified = clock += 1000;
    count_bytes();
  }

  void restart(Crash crash, std::uint64_t seed);
};

void SimulatedDisk::State::restart(Crash crash, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  open_files.clear();
  locks.clear();
  if (crash == Crash::kForget || crash == Crash::kTear) {
    // What was removed, but not durably, comes back with what is durable of it.
    for (NameChange& change : pending)
      if (crash == Crash::kTear && random() % 2 == 0) change.apply();
    const auto restore = [&](const auto& self, const NodePtr& node) -> void {
      if (node->directory) {
        node->names = node->durable_names;
        for (const auto& [name, child] : node->names) self(self, child);
      } else if (crash == Crash::kTear) {
        tear(*node, random);
      } else {
        node->bytes = node->durable;
        node->modified = node->durable_modified;
      }
    };
    restore(restore, root);
  }
  if (crash == Crash::kGarble) each(root, [&](Node& node) { garble(node, random); });
  if (crash != Crash::kKeep) {  // else what was not synced is still in the machine's memory
    pending.clear();
    each(root, [](Node& node) {
      settle(node);
      node.durable_names = node.names;
    });
  }
  crashed = false;
  crash_at = std::numeric_limits<std::uint64_t>::max();
  fault = {};
  calls = changed = 0;
  clock += 1'000'000'000;
  count_bytes();
}

namespace {

SimulatedDisk::State* current = nullptr;  // what io/disk.h leads to: its calls know no object

}  // namespace

SimulatedDisk::SimulatedDisk() : state_(new State) {
  assert(current == nullptr);
  current = state_;
}

SimulatedDisk::~SimulatedDisk() {
  current = nullptr;
  delete state_;
}

void SimulatedDisk::set_fault(FaultAt fault) { state_->fault = std::move(fault); }

void SimulatedDisk::crash_before(std::uint64_t n) { state_->crash_at = state_->changed + n; }

bool SimulatedDisk::crashed() const { return state_->crashed; }

void SimulatedDisk::restart(Crash crash, std::uint64_t seed) { state_->restart(crash, seed); }

std::uint64_t SimulatedDisk::changes_made() const { return state_->changed; }

std::uint64_t SimulatedDisk::calls_made() const { return state_->calls; }

void SimulatedDisk::set_capacity(std::uint64_t bytes) { state_->capacity = bytes; }

std::uint64_t SimulatedDisk::largest_use() const { return state_->largest; }

void SimulatedDisk::put(const std::string& path, std::span<const std::byte> bytes) {
  const auto [folder, name] = split(path);
  const NodePtr directory = state_->find(folder);
  const NodePtr file = state_->make_node(false);
  file->bytes.assign(bytes.begin(), bytes.end());
  settle(*file);
  directory->names[name] = directory->durable_names[name] = file;
  state_->count_bytes();
}

std::vector<std::string> SimulatedDisk::files() const {
  std::vector<std::string> paths;
  const auto visit = [&](const auto& self, const Node& node, const std::string& path) -> void {
    if (!node.directory) paths.push_back(path);
    for (const auto& [name, child] : node.names) self(self, *child, path + "/" + name);
  };
  visit(visit, *state_->root, "");
  return paths;
}

bool SimulatedDisk::has(const std::string& path) const { return state_->find(path) != nullptr; }

std::vector<std::byte> SimulatedDisk::content(const std::string& path) const {
  const NodePtr file = state_->find(path);
  return file ? file->bytes : Bytes();
}

void SimulatedDisk::flip_bit(const std::string& path, std::uint64_t bit) {
  const NodePtr file = state_->find(path);
  file->bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
  settle(*file);
}

void SimulatedDisk::remove(const std::string& path) {
  const auto [folder, name] = split(path);
  const NodePtr directory = state_->find(folder);
  directory->names.erase(name);
  directory->durable_names.erase(name);
}

}  // namespace pss::test

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
      : disk(*test::current), lock(disk.mutex), fault(disk.before(call, path)) {}
  Entered(Call call, int descriptor)
      : disk(*test::current),
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
  if (file && file->directory) return how == Open::kRead ? entered.disk.give(file, path) : -EISDIR;
  if (!file) {
    if (how == Open::kRead || how == Open::kReadWrite) return -ENOENT;
    const auto [folder, name] = test::split(path);
    const NodePtr directory = entered.disk.find(folder);
    if (!directory) return -ENOENT;
    file = entered.disk.make_node(false);
    entered.disk.link(directory, name, file);
  } else if (how == Open::kCreate) {
    entered.disk.resize(*file, 0);
  }
  return entered.disk.give(file, path);
}

void close(int descriptor) {
  test::SimulatedDisk::State& disk = *test::current;
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
  test::Node& file = entered.disk.file_of(descriptor);
  if (entered.failed()) {
    file.lost = file.lost || !entered.disk.crashed;
    return entered.error();
  }
  if (!file.lost) test::settle(file);
  return 0;
}

Outcome lock(int descriptor, Lock /*kind*/) {
  Entered entered(Call::kLock, descriptor);
  if (entered.failed()) return entered.error();
  const auto [held, taken] =
      entered.disk.locks.try_emplace(&entered.disk.file_of(descriptor), descriptor);
  return taken || held->second == descriptor ? 0 : -EWOULDBLOCK;
}

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

Outcome sync_directory(const std::string& path) {
  Entered entered(Call::kSyncDirectory, path);
  if (entered.failed()) return entered.error();
  const NodePtr directory = entered.disk.find(path);
  if (!directory) return -ENOENT;
  entered.disk.sync_names(directory);
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
