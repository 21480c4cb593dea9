// Every form of new and delete, so that sanitizers, which replace them all, see none of theirs
// mixed with one of these.

#include "tests/fuzz/allocations.h"

#include <malloc.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

// operator new knows no object.
std::atomic<std::int64_t> live{0};
std::atomic<std::int64_t> bound{kNone};

void* allocate(std::size_t size) noexcept {
  // Asked before it is done: a claim of terabytes is found on every machine.
  const std::int64_t room = bound - live;
  if (room < 0 || size > static_cast<std::uint64_t>(room)) {
    std::fprintf(stderr, "an allocation of %zu bytes is %lld too many\n", size,
                 static_cast<long long>(size) - static_cast<long long>(room));
    std::abort();
  }
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory) live += static_cast<std::int64_t>(malloc_usable_size(memory));
  return memory;
}

void* allocate_or_throw(std::size_t size) {
  void* memory = allocate(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void release(void* memory) noexcept {
  if (memory) live -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return allocate_or_throw(size); }
void* operator new[](std::size_t size) { return allocate_or_throw(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { release(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { release(memory); }

namespace pss::test {

AllocationBound::AllocationBound(std::size_t bytes) {
  bound = live + static_cast<std::int64_t>(bytes);
}

AllocationBound::~AllocationBound() { bound = kNone; }

}  // namespace pss::test
