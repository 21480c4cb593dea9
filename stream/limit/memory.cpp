#include "stream/limit/memory.h"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "stream/limit/cgroup.h"

namespace pss {
namespace {

constexpr std::uint64_t kMiB = 1u << 20;
/// Code, shared libraries, stream buffers, the small tables of a job: measured at 22 to 26 MiB.
constexpr std::uint64_t kProgramBytes = 32 * kMiB;
/// A worker's stack, scratch for one query, and what the allocator keeps for it.
constexpr std::uint64_t kThreadBytes = 4 * kMiB;

/// A line "Name:   123 kB" of /proc/self/status, in bytes; 0 where there is none.
std::uint64_t status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != name) continue;
    std::uint64_t kilobytes = 0;
    status >> kilobytes;
    return kilobytes * 1024;
  }
  return 0;
}

std::string content(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Reservation::Reservation(Reservation&& other) noexcept
    : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}

Reservation& Reservation::operator=(Reservation&& other) noexcept {
  if (this != &other) {
    release();
    budget_ = std::exchange(other.budget_, nullptr);
    bytes_ = std::exchange(other.bytes_, 0);
  }
  return *this;
}

Reservation::~Reservation() { release(); }

void Reservation::release() {
  if (budget_) budget_->used_ -= bytes_;
  budget_ = nullptr;
  bytes_ = 0;
}

void Reservation::shrink_to(std::uint64_t bytes) {
  if (!budget_ || bytes >= bytes_) return;
  budget_->used_ -= bytes_ - bytes;
  bytes_ = bytes;
}

MemoryBudget::MemoryBudget(std::uint64_t limit, int threads) : limit_(limit) {
  const std::uint64_t own = kProgramBytes + kThreadBytes * static_cast<std::uint64_t>(threads);
  total_ = limit > own ? limit - own : 0;
  usual_ = minimum_limit(threads) - own;
}

std::optional<Reservation> MemoryBudget::reserve(std::uint64_t bytes) {
  std::uint64_t used = used_.load();
  do {
    if (bytes > total_ - used) return std::nullopt;
  } while (!used_.compare_exchange_weak(used, used + bytes));
  return Reservation(this, bytes);
}

Result<Reservation> MemoryBudget::take(std::uint64_t bytes, const std::string& what) {
  if (auto reservation = reserve(bytes)) return *std::move(reservation);
  return refusal(what, bytes);
}

Error MemoryBudget::refusal(const std::string& what, std::uint64_t bytes,
                            const std::string& or_else) const {
  const std::uint64_t left = available();
  return {Fault::kMemoryLimit,
          fmt::format("{} takes {} MiB of memory, {} MiB are left of the limit; use --memory-limit "
                      "{}M or more{}",
                      what, (bytes + kMiB - 1) / kMiB, left / kMiB,
                      sufficient_mib(limit_, left, bytes), or_else)};
}

bool MemoryBudget::grow(Reservation& reservation, std::uint64_t bytes) {
  if (bytes <= reservation.bytes_) return true;
  auto more = reserve(bytes - reservation.bytes_);
  if (!more) return false;
  reservation.budget_ = this;
  reservation.bytes_ = bytes;
  more->budget_ = nullptr;  // it is the other's now
  return true;
}

std::uint64_t sufficient_mib(std::uint64_t limit, std::uint64_t left, std::uint64_t needed) {
  return (limit + (needed > left ? needed - left : 0) + kMiB - 1) / kMiB;
}

std::uint64_t minimum_limit(int threads) {
  return 80 * kMiB + 8 * kMiB * static_cast<std::uint64_t>(threads);
}

std::uint64_t machine_memory() {
  const auto pages = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES));
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return std::min(pages * page, cgroup_memory_limit(content("/proc/self/cgroup")));
}

std::uint64_t default_limit() { return machine_memory() / 10 * 7; }

std::uint64_t peak_resident() { return status_bytes("VmHWM:"); }
std::uint64_t current_resident() { return status_bytes("VmRSS:"); }

void configure_allocator() {
  // Arrays of a part come from mmap and go back at once; two arenas keep fragmentation small.
  mallopt(M_MMAP_THRESHOLD, 128 * 1024);
  mallopt(M_TRIM_THRESHOLD, 256 * 1024);
  mallopt(M_ARENA_MAX, 2);
}

}  // namespace pss
