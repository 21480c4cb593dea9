#include "tests/support/simulated_disk.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <random>

#include "tests/support/simulated_disk_state.h"

namespace pss::test {
namespace {

constexpr std::uint64_t kBlock = 512;  ///< what a disk writes whole or not at all

SimulatedDisk::State* current = nullptr;

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

}  // namespace

void settle(Node& file) {
  file.durable = file.bytes;
  file.durable_modified = file.modified;
  file.unsynced.clear();
  file.lost = false;
}

SimulatedDisk::State& current_disk() {
  assert(current != nullptr);
  return *current;
}

std::pair<std::string, std::string> split(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  assert(slash != std::string::npos);
  return {path.substr(0, slash), path.substr(slash + 1)};  // no path here ends in a slash
}

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
  lie_in = 0;
  calls = changed = 0;
  clock += 1'000'000'000;
  count_bytes();
}

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

void SimulatedDisk::lie_at(std::uint64_t n) { state_->lie_in = n; }

const std::string& SimulatedDisk::lied_about() const { return state_->lied_about; }

bool SimulatedDisk::crashed() const { return state_->crashed; }

void SimulatedDisk::restart(Crash crash, std::uint64_t seed) { state_->restart(crash, seed); }

std::uint64_t SimulatedDisk::changes_made() const { return state_->changed; }

std::uint64_t SimulatedDisk::calls_made() const { return state_->calls; }

void SimulatedDisk::set_capacity(std::uint64_t bytes) { state_->capacity = bytes; }

std::uint64_t SimulatedDisk::largest_use() const { return state_->largest; }

void SimulatedDisk::put(const std::string& path, std::span<const std::byte> bytes) {
  const auto [folder, name] = split(path);
  const NodePtr file = state_->make_node(false);
  const NodePtr directory = state_->make_directories(folder);
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
