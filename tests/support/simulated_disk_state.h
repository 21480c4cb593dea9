#pragma once
// What a simulated disk holds: files and names as programs see them, and as a crash may leave them.

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/simulated_disk.h"

namespace pss::test {

using Bytes = std::vector<std::byte>;

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

/// All that is there is durable now.
void settle(Node& file);

/// A change of names that is not durable yet: `apply` to what is durable.
struct NameChange {
  std::vector<NodePtr> directories;
  std::function<void()> apply;
};

/// The folder and the name in it.
std::pair<std::string, std::string> split(const std::string& path);

struct SimulatedDisk::State {
  struct OpenFile {
    NodePtr file;
    std::string path;
    bool to_fail = false;  ///< a sync by another descriptor failed: this one hears of it once
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
  std::uint64_t lie_in = 0;  ///< syncs until the one that does nothing; 0: none
  std::string lied_about;
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

  /// Whether this sync is the one that lies.
  bool lies(Call call, const std::string& path) {
    if (lie_in == 0 || --lie_in > 0) return false;
    lied_about = std::string(name_of(call)) + " " + path;
    return true;
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

  void swap(const NodePtr& a, const std::string& name, const NodePtr& b,
            const std::string& other_name) {
    const NodePtr first = a->names.at(name), second = b->names.at(other_name);
    change_names({a, b}, [=](bool durable) {
      names_of(a, durable)[name] = second;
      names_of(b, durable)[other_name] = first;
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

  /// The folder at a path, made durably where it is missing.
  NodePtr make_directories(const std::string& path) {
    if (NodePtr there = find(path)) return there;
    const auto [folder, name] = split(path);
    const NodePtr parent = make_directories(folder);
    return parent->names[name] = parent->durable_names[name] = make_node(true);
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

  /// A sync by one descriptor has failed: every other one that is open now hears of it, too.
  void lose(const NodePtr& file, int descriptor) {
    file->lost = true;
    for (auto& [other, open] : open_files)
      open.to_fail = open.to_fail || (open.file == file && other != descriptor);
  }

  void resize(Node& file, std::uint64_t size) {
    if (size > file.bytes.size()) file.unsynced.push_back({file.bytes.size(), size});
    file.bytes.resize(size);
    file.modified = clock += 1000;
    count_bytes();
  }

  void restart(Crash crash, std::uint64_t seed);
};

/// What the calls of io/file/disk.h lead to: they know no object.
SimulatedDisk::State& current_disk();

}  // namespace pss::test
